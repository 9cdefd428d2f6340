//! Which clusters can be seen? Twin of `shaders/cull_clusters.wgsl`.

use super::shared::scene::{Scene, bounds_of, row};
use crate::meshes::bounds::ClusterBounds;
use crate::meshes::params::TWO_SIDED;
use crate::meshes::units::DrawnCluster;
use glam::Vec4;

fn reaches(plane: Vec4, bounds: &ClusterBounds) -> bool {
    let away = plane.truncate().dot(bounds.centre) + plane.w;
    away >= -bounds.radius * plane.truncate().length()
}

fn meets_field(scene: &Scene, placement: u32, bounds: &ClusterBounds) -> bool {
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

fn shows_back(scene: &Scene, placement: u32, bounds: &ClusterBounds) -> bool {
    let eye = row(scene.placements[placement as usize].eye_in_grid);
    let is_two_sided = scene.placements[placement as usize].flags & TWO_SIDED != 0;
    if eye.w == 0.0 || is_two_sided {
        return false;
    }
    let away = bounds.centre - eye.truncate();
    away.dot(bounds.axis) >= bounds.spread * away.length() + bounds.radius
}

/// Whether a cluster can be seen where it stands.
pub(super) fn cull_clusters(scene: &Scene, block: &DrawnCluster<'_>, placement: u32) -> bool {
    let bounds = bounds_of(block);
    meets_field(scene, placement, &bounds) && !shows_back(scene, placement, &bounds)
}
