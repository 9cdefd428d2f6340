//! How coarse may the picture look at a place, without a visible border between tiles? Twin of
//! `shaders/shared/footprint.wgsl`.

use super::tiles::{TwinTiles, cell_at, scale_of, shown_in};
use super::{cube, plane};
use foveal_core::view::surface::Projection;
use glam::{UVec2, Vec2};

pub(super) fn widened(tiles: &TwinTiles, face: u32, place: Vec2, known: f32) -> f32 {
    let reach = tiles.params.growth * (tiles.params.coarsest_scale - known);
    if reach <= 0.0 {
        return known;
    }
    let from_cell = cell_at(tiles, place - reach);
    let to_cell = cell_at(tiles, place + reach);
    let mut widest = known;
    for y in from_cell.y..=to_cell.y {
        for x in from_cell.x..=to_cell.x {
            let cell = Vec2::from(tiles.params.cell);
            let low = UVec2::new(x, y).as_vec2() * cell;
            let high = (low + cell).min(tiles.size());
            let away = (low - place).max(place - high).max(Vec2::ZERO).length();
            let scale = scale_of(tiles, shown_in(tiles, face, UVec2::new(x, y)));
            widest = widest.max(scale - away / tiles.params.growth);
        }
    }
    widest
}

pub(super) fn shown_footprint(
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
    }
}

pub(super) fn level_of(tiles: &TwinTiles, footprint: f32) -> f32 {
    let level = footprint.log2() / tiles.params.octaves as f32;
    level.clamp(0.0, tiles.params.coarsest as f32)
}
