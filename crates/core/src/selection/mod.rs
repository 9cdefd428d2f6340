//! What to show and fetch: levels for every cell and the tiles that follow.

pub mod asked;
pub mod calibration;
pub mod chooser;
pub mod content;
pub mod distance;
pub mod greedy;
pub mod level_map;
pub mod losses;
pub mod policy;
pub mod refine;
pub mod steady;
pub mod target;
pub mod worth;

mod need;
mod neighbours;
mod places;
mod sight;
