//! How coarse may a place of one face look, for the cells nearby? Twin of
//! `shaders/shared/widened.wgsl`.

use super::tiles::{TwinTiles, cell_at, scale_of, shown_in};
use glam::{UVec2, Vec2};

pub(crate) fn widened(tiles: &TwinTiles, face: u32, place: Vec2, known: f32) -> f32 {
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
