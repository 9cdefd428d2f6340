//! What the commands do with scenes.

pub(crate) mod prepare;
pub(crate) mod scene_info;
pub(crate) mod verify;
