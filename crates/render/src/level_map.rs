//! Which level does every cell show?

use foveal_core::asset::tile_grid::{Tile, TileGrid};

/// The finest of `tiles` over every cell, the coarsest level where there is none; face-major, then
/// rows, then columns.
#[must_use]
pub(crate) fn level_map(grid: &TileGrid, tiles: impl IntoIterator<Item = Tile>) -> Vec<u32> {
    let cells = grid.tiles_in_level(0) as usize;
    let mut map = vec![u32::from(grid.coarsest()); cells];
    let [columns, rows] = grid.cells();
    let cell_span = grid.span(0);
    for tile in tiles {
        let (origin, covered) = (grid.origin(tile), grid.covered(tile));
        let from = [0, 1].map(|k| origin[k] / cell_span[k]);
        let to = [0, 1].map(|k| (origin[k] + covered[k]).div_ceil(cell_span[k]));
        for y in from[1]..to[1] {
            let row = ((u32::from(tile.face) * rows + y) * columns) as usize;
            for entry in &mut map[row + from[0] as usize..row + to[0] as usize] {
                *entry = (*entry).min(u32::from(tile.level));
            }
        }
    }
    map
}

/// Whether the grid has this tile.
#[must_use]
pub(crate) fn contains(grid: &TileGrid, tile: Tile) -> bool {
    if tile.level >= grid.levels || u32::from(tile.face) >= grid.faces() {
        return false;
    }
    let [columns, rows] = grid.tiles(tile.level);
    u32::from(tile.x) < columns && u32::from(tile.y) < rows
}
