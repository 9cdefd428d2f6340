//! How coarse may the picture look at a place, without a visible border between tiles? Twin of
//! `shaders/shared/footprint.wgsl`.

use super::tiles::TwinTiles;
use super::widened::widened;
use super::{cube, equirect, plane};
use foveal_core::view::surface::Projection;
use glam::Vec2;

pub(crate) fn shown_footprint(
    tiles: &TwinTiles,
    face: u32,
    place: Vec2,
    display: f32,
    own: f32,
) -> f32 {
    let widest = widened(tiles, face, place, display.max(own));
    match tiles.grid.surface.projection {
        Projection::Flat => plane::widened_across(widest),
        Projection::Cube => cube::widened_across(tiles, face, place, widest),
        Projection::Equirect => equirect::widened_across(tiles, face, place, widest),
    }
}

pub(crate) fn level_of(tiles: &TwinTiles, footprint: f32) -> f32 {
    let level = footprint.log2() / tiles.params.octaves as f32;
    level.clamp(0.0, tiles.params.coarsest as f32)
}
