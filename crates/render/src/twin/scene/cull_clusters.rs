//! Which clusters can be seen, and which triangles have they? Twin of `shaders/cull_clusters.wgsl`.

use super::halve_depths::{depth_start, first_depths, halve_depths};
use crate::meshes::bounds::ClusterBounds;
use crate::meshes::hiding::{levels, sides};
use crate::meshes::units::DrawnCluster;
use crate::scene::params::{BACKS, MIRRORED, OUTSIDE, TWO_SIDED};
use crate::twin::shared::scene::{SceneInView, bounds_of, row, times, triangles_of, vertex_at};
use glam::{Vec2, Vec3, Vec4};

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

/// What rounding takes from a depth at most, as a factor.
const DEPTH_SLACK: f32 = 1.0001;

/// What was drawn, and how near the farthest of it is in squares of pixels.
pub(crate) struct DrawnDepths {
    scene: SceneInView,
    /// Of all levels, one behind the other.
    depths: Vec<f32>,
}

impl DrawnDepths {
    /// Of a picture's depths, row by row.
    pub(super) fn new(scene: SceneInView, drawn: &[f32]) -> Self {
        let size = scene.params.picture;
        let mut depths = first_depths(size, drawn);
        (2..=levels(size)).for_each(|level| halve_depths(size, level, &mut depths));
        Self { scene, depths }
    }
}

/// Whether all that a cluster's sphere may hold lies behind what was drawn.
pub(super) fn is_hidden(drawn: &DrawnDepths, block: &DrawnCluster<'_>, placement: u32) -> bool {
    let bounds = bounds_of(block);
    let scene = &drawn.scene.params;
    let rows = &drawn.scene.placements[placement as usize].view_from_grid;
    let centre = times(rows, bounds.centre.extend(1.0));
    let stretch = Vec3::from(rows.map(|it| row(it).truncate().length()));
    let low = centre - bounds.radius * stretch;
    let high = centre + bounds.radius * stretch;
    if low.z <= scene.near {
        return false;
    }
    let [x, y, z, w] = scene.clip_from_view;
    let half = Vec2::new(0.5, -0.5);
    let [scale, shift] = [Vec2::new(x, y) * half, Vec2::new(z, w) * half + 0.5];
    let size = Vec2::from(scene.picture.map(|side| side as f32));
    let [near, far] = [low.truncate(), high.truncate()];
    let first = ((near / low.z).min(near / high.z) * scale + shift) * size;
    let last = ((far / low.z).max(far / high.z) * scale + shift) * size;
    let least = (first.floor() - 1.0)
        .clamp(Vec2::ZERO, size - 1.0)
        .as_uvec2();
    let most = (last.floor() + 1.0)
        .clamp(Vec2::ZERO, size - 1.0)
        .as_uvec2();
    let span = (most - least).max_element().max(2);
    let level = u32::BITS - (span - 1).leading_zeros();
    let [columns, _] = sides(scene.picture, level);
    let start = depth_start(scene.picture, level);
    let [low_at, high_at] = [least >> level, most >> level];
    let at = |x: u32, y: u32| drawn.depths[start + (y * columns + x) as usize];
    let above = at(low_at.x, low_at.y).min(at(high_at.x, low_at.y));
    let below = at(low_at.x, high_at.y).min(at(high_at.x, high_at.y));
    let farthest = above.min(below);
    scene.near / low.z * DEPTH_SLACK < farthest
}

pub(super) fn is_seen(scene: &SceneInView, block: &DrawnCluster<'_>, placement: u32) -> bool {
    let bounds = bounds_of(block);
    let culls = scene.params.culls;
    (culls & OUTSIDE == 0 || meets_field(scene, placement, &bounds))
        && (culls & BACKS == 0 || !shows_back(scene, placement, &bounds))
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
