//! What is shown over every cell?

use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};

/// Bits of an entry that hold the level; the rest is the caller's.
pub(crate) const LEVEL_BITS: u32 = 4;

/// For every cell the entry of the finest of `tiles` over it, the coarsest level where there is
/// none; face-major, then rows, then columns. An entry's low bits are its tile's level.
#[must_use]
pub(crate) fn shown_map(grid: &TileGrid, tiles: impl IntoIterator<Item = (Tile, u32)>) -> Vec<u32> {
    let cells = grid.tiles_in_level(0) as usize;
    let mut map = vec![u32::from(grid.coarsest()); cells];
    let [columns, rows] = grid.cells();
    let cell_span = grid.span(0);
    for (tile, entry) in tiles {
        let (origin, covered) = (grid.origin(tile), grid.covered(tile));
        let from = [0, 1].map(|k| origin[k] / cell_span[k]);
        let to = [0, 1].map(|k| (origin[k] + covered[k]).div_ceil(cell_span[k]));
        for y in from[1]..to[1] {
            let row = ((u32::from(tile.face) * rows + y) * columns) as usize;
            for shown in &mut map[row + from[0] as usize..row + to[0] as usize] {
                if level_in(entry) < level_in(*shown) {
                    *shown = entry;
                }
            }
        }
    }
    map
}

/// The level of an entry.
#[must_use]
pub(crate) fn level_in(entry: u32) -> u32 {
    entry & ((1 << LEVEL_BITS) - 1)
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
