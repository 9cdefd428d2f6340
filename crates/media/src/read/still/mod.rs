//! Pictures: what their files say, and those that FFmpeg does not read whole.

pub(crate) mod animation_canvas;
pub mod heif_boxes;
pub(crate) mod heif_still;
pub(crate) mod large_still;
pub mod still_tags;
pub(crate) mod webp_input;
