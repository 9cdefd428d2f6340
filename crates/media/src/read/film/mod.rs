//! Films and streams: packets to frames, and what is mended on the way.

pub mod animation_end;
pub mod behind_end;
pub mod clusters;
pub(crate) mod corrected_file;
pub mod corrections;
pub mod cut_short;
pub(crate) mod damage_log;
pub mod deinterlace;
pub(crate) mod film_notes;
pub(crate) mod frame_reader;
pub(crate) mod frames;
pub(crate) mod holes;
pub(crate) mod joints;
pub mod mended;
pub(crate) mod mending;
pub mod mp4_says;
pub(crate) mod opening;
pub(crate) mod other_file;
pub(crate) mod stream_input;
pub(crate) mod timeline;
pub(crate) mod track_choice;
