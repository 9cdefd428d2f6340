//! Scenes: layers of units of all kinds, and the pictures that are drawn of them.

pub mod coming;
pub mod corner_pass;
pub mod footprints;
pub mod kind;
pub(crate) mod layer;
pub(crate) mod measuring;
pub(crate) mod morphs;
pub mod params;
pub mod phase;
pub mod placements;
pub(crate) mod targets;
