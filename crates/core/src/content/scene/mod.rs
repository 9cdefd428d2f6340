//! Scenes: objects of units that stand in space.

mod content;
pub mod demand;
pub mod description;
pub mod pack;
pub mod scene;
pub mod scripted;
pub mod sight;
pub mod unit_table;

pub use scene::Scene;
