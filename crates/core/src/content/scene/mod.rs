//! Scenes: objects of units that stand in space.

mod content;
pub mod demand;
pub mod description;
pub mod kind;
pub mod lighting;
pub mod object_table;
pub mod pack;
pub mod part_ref;
#[allow(
    clippy::module_inception,
    reason = "the room of scenes holds one type of that name"
)]
mod scene;
pub mod scripted;
pub mod showing;
pub mod sight;
pub mod unit_table;
pub mod whole;
pub mod worth;

pub use scene::Scene;
