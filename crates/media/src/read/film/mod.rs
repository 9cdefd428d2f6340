//! Films and streams: packets to frames, and what is mended on the way.

pub mod clusters;
pub mod corrected;
pub(crate) mod damage_log;
pub mod deinterlace;
pub mod ends;
pub(crate) mod film_notes;
pub(crate) mod frame_reader;
pub(crate) mod frames;
pub(crate) mod holes;
pub mod mended;
pub(crate) mod mending;
pub(crate) mod opening;
pub(crate) mod stream_input;
pub(crate) mod timeline;
pub(crate) mod track_choice;
