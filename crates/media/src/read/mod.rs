//! Pictures and sound out of whatever FFmpeg reads.

pub(crate) mod convert;
pub(crate) mod deliver;
pub mod film;
pub(crate) mod frame;
pub mod input;
pub(crate) mod light;
pub mod options;
pub(crate) mod orientation;
pub(crate) mod sound_reader;
pub mod source;
pub mod still;
