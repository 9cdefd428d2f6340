//! How do the triangles of an object become units of its levels?

pub(super) mod clusters;
pub(super) mod graph;
pub(super) mod grid_mesh;
pub(super) mod groups;
pub(super) mod simplify;
pub(super) mod units;
