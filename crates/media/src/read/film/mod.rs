//! Films and streams: packets to frames, and what is mended on the way.

pub mod animation_end;
pub mod clusters;
pub mod cut_short;
pub(crate) mod damage_log;
pub mod deinterlace;
pub(crate) mod frame_reader;
pub(crate) mod frames;
pub(crate) mod holes;
pub(crate) mod joints;
pub mod mended;
pub(crate) mod mending;
pub(crate) mod opening;
pub(crate) mod stream_input;
pub(crate) mod timeline;
