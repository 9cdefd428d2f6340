//! What plays a pack without a window, and the packs and sources that it is given.

pub(crate) mod canvas;
pub(crate) mod kept_pack;
pub(crate) mod loss;
pub(crate) mod pack_place;
pub(crate) mod player;
pub(crate) mod sampling;
pub(crate) mod scene_clip;
pub(crate) mod source_frames;
pub(crate) mod timed;
