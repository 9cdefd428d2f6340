//! Scenes: objects of units that stand in space.

pub mod description;
pub mod unit_table;
