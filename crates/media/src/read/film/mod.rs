//! Films and streams: packets to frames, and what is mended on the way.

pub(crate) mod cut_short;
pub mod deinterlace;
pub(crate) mod frame_reader;
pub(crate) mod frames;
pub mod mended;
pub(crate) mod mending;
pub(crate) mod opening;
pub(crate) mod stream_input;
pub(crate) mod timeline;
