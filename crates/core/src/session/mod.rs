//! What one viewer is shown as time goes on, and the log that replays it.

pub mod aim;
pub mod budget;
pub mod figures;
pub mod log;
pub mod log_of_parts;
pub mod media_clock;
pub mod picker;
pub mod playback;
pub mod timeline;
