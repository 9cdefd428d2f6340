//! What to show and fetch: levels for every cell, the tiles that follow, the log that replays.

pub mod aim;
pub mod asked;
pub mod budget;
pub mod calibration;
pub mod chooser;
pub mod content;
pub mod distance;
pub mod figures;
pub mod greedy;
pub mod level_map;
pub mod losses;
pub mod picker;
pub mod policy;
pub mod refine;
pub mod session;
pub mod session_log;
pub mod stage;
pub mod steady;
pub mod target;
pub mod worth;

mod need;
mod neighbours;
mod places;
mod sight;
