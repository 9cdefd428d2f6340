//! Which colour does a pixel of a view get when every level has a texture of its own? Twin of
//! `shaders/reconstruct_textures.wgsl`.

use super::shared::colour::rgb_from_yuv;
use super::shared::screen::View;
use super::shared::tiles::{Plane, TwinTiles, cell_at, fetch, shown_in};
use super::shared::{cube, equirect, plane};
use foveal_core::view::surface::Projection;
use glam::{Vec2, Vec3, Vec4};

pub(super) fn reconstruct_textures(tiles: &TwinTiles, view: &View, position: Vec2) -> Vec4 {
    let seen = match tiles.grid.surface.projection {
        Projection::Flat => plane::seen_by(tiles, view, position),
        Projection::Cube => cube::seen_by(tiles, view, position),
        Projection::Equirect => equirect::seen_by(tiles, view, position),
    };
    if !seen.inside {
        return Vec4::new(0.0, 0.0, 0.0, 1.0);
    }
    let level = shown_in(tiles, seen.face, cell_at(tiles, seen.place));
    let luma = fetch(tiles, Plane::Luma, level, seen.face, seen.place);
    let chroma = fetch(tiles, Plane::Chroma, level, seen.face, seen.place);
    rgb_from_yuv(tiles, Vec3::new(luma.x, chroma.x, chroma.y)).extend(1.0)
}
