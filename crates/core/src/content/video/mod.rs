//! Video: pictures in time, as tiles of several levels.

pub mod bytes;
pub mod grid;
pub mod losses;
pub mod rules;
pub mod units;
pub mod worth;
