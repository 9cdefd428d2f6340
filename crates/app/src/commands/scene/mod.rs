//! What the commands do with scenes.

pub(crate) mod judging;
pub(crate) mod moving;
pub(crate) mod prepare;
pub(crate) mod scene_info;
pub(crate) mod simulate;
