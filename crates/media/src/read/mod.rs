//! Pictures and sound out of whatever FFmpeg reads.

pub(crate) mod convert;
pub(crate) mod cut_short;
pub mod deinterlace;
pub(crate) mod deliver;
pub(crate) mod frame;
pub(crate) mod frame_reader;
pub(crate) mod frames;
pub mod heif_boxes;
pub(crate) mod heif_still;
pub mod input;
pub(crate) mod large_still;
pub mod mended;
pub(crate) mod mending;
pub(crate) mod opening;
pub(crate) mod orientation;
pub(crate) mod sound_reader;
pub mod source;
pub mod still_tags;
pub(crate) mod stream_input;
pub(crate) mod timeline;
pub(crate) mod webp_input;
