//! Video: pictures in time, as tiles of several levels.

pub mod bytes;
pub mod calibration;
pub mod demand;
mod glimpse;
pub mod grid;
pub mod losses;
mod purchases;
pub mod rules;
pub mod units;
#[allow(
    clippy::module_inception,
    reason = "the room of video holds one type of that name"
)]
mod video;
pub mod worth;

pub use video::Video;
