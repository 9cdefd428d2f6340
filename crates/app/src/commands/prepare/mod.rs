//! How do files become packs?

pub(crate) mod scene;
pub(crate) mod video;
