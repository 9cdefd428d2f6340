//! Which colour does a pixel of a view into a cube get? Twin of `shaders/reconstruct_cube.wgsl`.

use super::shared::cube::seen_by;
use super::shared::picture::picture_at;
use super::shared::screen::View;
use super::shared::tiles::TwinTiles;
use glam::{Vec2, Vec4};

pub(super) fn reconstruct_cube(tiles: &TwinTiles, view: &View, position: Vec2) -> Vec4 {
    let seen = seen_by(tiles, view, position);
    if !seen.inside {
        return Vec4::new(0.0, 0.0, 0.0, 1.0);
    }
    picture_at(tiles, seen.face, seen.place, seen.footprint).extend(1.0)
}
