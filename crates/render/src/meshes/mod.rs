//! Meshes: clusters of triangles on the GPU, and the pictures that are drawn of them.

mod arena;
pub(crate) mod bounds;
mod drawer;
pub mod footprints;
pub(crate) mod hiding;
mod layer;
mod lists;
mod measuring;
mod memory;
pub(crate) mod morphs;
pub mod params;
pub(crate) mod pass;
pub(crate) mod placements;
pub(crate) mod pool;
pub(crate) mod units;

pub use drawer::SceneDrawer;
pub use layer::SceneLayer;
pub use memory::unit_bytes;
pub use params::{Culling, SceneStyle};
pub use units::ComingUnit;
