//! Meshes: clusters of triangles in units, each of which shows a region one level finer.

pub mod cut;
mod morph;
pub mod octahedral;
pub mod payload;
