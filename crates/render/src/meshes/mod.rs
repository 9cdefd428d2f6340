//! Meshes: clusters of triangles on the GPU, and what draws them.

pub(crate) mod bounds;
pub(crate) mod hiding;
pub(crate) mod layer;
pub(crate) mod lists;
pub(crate) mod memory;
pub(crate) mod pass;
pub(crate) mod units;

pub use memory::unit_bytes;
