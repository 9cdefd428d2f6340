//! Where do clusters lie, and how do objects stand before the eye? Twin of
//! `shaders/shared/scene.wgsl`.

use crate::meshes::bounds::ClusterBounds;
use crate::meshes::units::DrawnCluster;
use crate::scene::params::{PlacementParams, SceneParams};
use foveal_core::content::mesh::payload::MeshVertex;
use glam::{Vec3, Vec4};

/// What a view shows, and objects where they stand.
pub(crate) struct SceneInView {
    pub(crate) params: SceneParams,
    pub(crate) placements: Vec<PlacementParams>,
}

pub(crate) fn bounds_of(block: &DrawnCluster<'_>) -> ClusterBounds {
    block.note.bounds(block.cluster)
}

/// Number of its triangles.
pub(crate) fn triangles_of(block: &DrawnCluster<'_>) -> u32 {
    block.placed.clusters[block.cluster].triangles.len() as u32
}

/// Which of a cluster's vertices is at a corner of its triangles. In a mirror corners come the
/// other way round.
pub(crate) fn vertex_at(block: &DrawnCluster<'_>, mirrored: bool, corner: u32) -> u32 {
    let turn = corner % 3;
    let taken = if mirrored { (3 - turn) % 3 } else { turn };
    let triangle = block.placed.clusters[block.cluster].triangles[corner as usize / 3];
    u32::from(triangle[taken as usize])
}

/// A vertex of a cluster, by its number in it.
pub(crate) fn vertex_of(block: &DrawnCluster<'_>, number: u32) -> MeshVertex {
    block.vertex_now(number)
}

/// A row of a matrix.
pub(crate) fn row(row: [f32; 4]) -> Vec4 {
    Vec4::from(row)
}

/// Three rows with a place.
pub(crate) fn times(rows: &[[f32; 4]; 3], place: Vec4) -> Vec3 {
    Vec3::from([0, 1, 2].map(|k| row(rows[k]).dot(place)))
}
