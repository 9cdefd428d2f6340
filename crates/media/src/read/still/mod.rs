//! Pictures: what their files say, and those that FFmpeg does not read whole.

pub(crate) mod animation_canvas;
pub(crate) mod decoded_still;
pub mod exr;
pub mod float_map;
pub mod heif_boxes;
pub(crate) mod heif_still;
pub(crate) mod large_still;
pub(crate) mod png_palette;
pub(crate) mod png_says;
pub mod qoi;
pub mod radiance;
pub mod still_tags;
pub mod tiff_head;
pub(crate) mod tiff_still;
pub(crate) mod webp_input;
pub(crate) mod webp_says;
