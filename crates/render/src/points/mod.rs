//! Points: clouds on the GPU, and the pictures that are drawn of them.

pub(crate) mod cubes;
pub(crate) mod layer;
mod memory;
pub mod params;
pub mod pass;
pub(crate) mod units;
