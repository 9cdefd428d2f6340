//! Scenes: the units of all kinds on the GPU, and the pictures that are drawn of them.

pub(crate) mod drawer;
pub mod footprints;
pub(crate) mod layer;
pub(crate) mod measuring;
pub(crate) mod morphs;
pub mod params;
pub(crate) mod phase;
pub(crate) mod placements;

pub use drawer::SceneDrawer;
pub use layer::SceneLayer;
pub use params::{Culling, SceneStyle};
