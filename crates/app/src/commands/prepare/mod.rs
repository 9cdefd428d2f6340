//! Files in, a pack out.

pub(crate) mod scene;
pub(crate) mod video;
