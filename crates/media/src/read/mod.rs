//! Pictures and sound out of whatever FFmpeg reads.

pub(crate) mod convert;
pub(crate) mod cut_short;
pub(crate) mod deliver;
pub(crate) mod frame;
pub(crate) mod frame_reader;
pub mod input;
pub(crate) mod large_still;
pub(crate) mod opening;
pub(crate) mod orientation;
pub(crate) mod sound_reader;
pub mod source;
pub mod still_tags;
pub(crate) mod timeline;
