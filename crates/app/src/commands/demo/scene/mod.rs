//! How is a mesh or a cloud watched through a link?

pub(super) mod content;
pub(super) mod watched;
