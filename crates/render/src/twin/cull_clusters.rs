//! Which clusters can be seen, and which triangles have they? Twin of `shaders/cull_clusters.wgsl`.

use super::shared::scene::{SceneInView, bounds_of, row, triangles_of, vertex_at};
use crate::meshes::bounds::ClusterBounds;
use crate::meshes::params::{MIRRORED, TWO_SIDED};
use crate::meshes::units::DrawnCluster;
use glam::Vec4;

fn reaches(plane: Vec4, bounds: &ClusterBounds) -> bool {
    let away = plane.truncate().dot(bounds.centre) + plane.w;
    away >= -bounds.radius * plane.truncate().length()
}

fn meets_field(scene: &SceneInView, placement: u32, bounds: &ClusterBounds) -> bool {
    let right = row(scene.placements[placement as usize].view_from_grid[0]);
    let down = row(scene.placements[placement as usize].view_from_grid[1]);
    let forward = row(scene.placements[placement as usize].view_from_grid[2]);
    let field = scene.params.field;
    reaches(right + forward * field[0], bounds)
        && reaches(forward * field[1] - right, bounds)
        && reaches(down + forward * field[2], bounds)
        && reaches(forward * field[3] - down, bounds)
        && reaches(
            forward - Vec4::new(0.0, 0.0, 0.0, scene.params.near),
            bounds,
        )
}

fn shows_back(scene: &SceneInView, placement: u32, bounds: &ClusterBounds) -> bool {
    let eye = row(scene.placements[placement as usize].eye_in_grid);
    let is_two_sided = scene.placements[placement as usize].flags & TWO_SIDED != 0;
    if eye.w == 0.0 || is_two_sided {
        return false;
    }
    let away = bounds.centre - eye.truncate();
    away.dot(bounds.axis) >= bounds.spread * away.length() + bounds.radius
}

pub(super) fn is_seen(scene: &SceneInView, block: &DrawnCluster<'_>, placement: u32) -> bool {
    let bounds = bounds_of(block);
    let meets = meets_field(scene, placement, &bounds) && !shows_back(scene, placement, &bounds);
    scene.params.culls == 0 || meets
}

/// The vertices at the corners of a cluster's triangles, by their numbers in it; none where it
/// cannot be seen.
pub(super) fn cull_clusters(
    scene: &SceneInView,
    block: &DrawnCluster<'_>,
    placement: u32,
) -> Vec<u32> {
    if !is_seen(scene, block, placement) {
        return Vec::new();
    }
    let mirrored = scene.placements[placement as usize].flags & MIRRORED != 0;
    let corners = 0..3 * triangles_of(block);
    corners
        .map(|corner| vertex_at(block, mirrored, corner))
        .collect()
}
