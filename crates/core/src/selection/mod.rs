//! What to show and fetch: levels for every cell, the tiles that follow, the log that replays.

pub mod greedy;
pub mod level_map;
pub mod policy;
pub mod session;

mod need;
mod neighbours;
