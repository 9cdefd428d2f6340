//! At which level is each part of the picture shown, and which tiles does that take?

use crate::asset::tile_grid::{Cut, Tile, TileGrid};

/// A level for every cell of a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelMap {
    /// Face-major, then rows, then columns: the rank of the cell.
    levels: Vec<u8>,
}

impl LevelMap {
    /// All cells at one level.
    #[must_use]
    pub fn filled(grid: &TileGrid, level: u8) -> Self {
        Self {
            levels: vec![level; grid.tiles_in_level(0) as usize],
        }
    }

    /// The level that `level_of` gives each cell.
    #[must_use]
    pub fn from_cells(grid: &TileGrid, level_of: impl FnMut(Tile) -> u8) -> Self {
        Self {
            levels: grid.tiles_of(0).map(level_of).collect(),
        }
    }

    /// Levels by rank of the cell.
    #[must_use]
    pub fn levels(&self) -> &[u8] {
        &self.levels
    }

    /// The level of a cell.
    #[must_use]
    pub fn level(&self, grid: &TileGrid, cell: Tile) -> u8 {
        self.levels[grid.rank(cell) as usize]
    }

    /// Makes a cell at least as fine as `level`.
    pub fn refine(&mut self, grid: &TileGrid, cell: Tile, level: u8) {
        let at = &mut self.levels[grid.rank(cell) as usize];
        *at = level.min(*at);
    }

    /// Number of cells whose level differs.
    #[must_use]
    pub fn changes_from(&self, before: &Self) -> u64 {
        self.levels
            .iter()
            .zip(&before.levels)
            .filter(|(a, b)| a != b)
            .count() as u64
    }

    /// The tiles that show every cell at its level or finer, coarsest first, by rank.
    ///
    /// In a pyramid a tile serves all cells under it, so cells that a finer neighbour's tile
    /// happens to cover become finer (this map is changed to say so), and the whole coarsest level
    /// is included: it is always resident. In a grid the regions are the same at every level and
    /// each cell is one tile.
    #[must_use]
    pub fn cover(&mut self, grid: &TileGrid) -> Vec<Tile> {
        let mut tiles = match grid.cut {
            Cut::Grid(_) => grid
                .tiles_of(0)
                .map(|cell| grid.tile_over(cell, self.level(grid, cell)))
                .collect(),
            Cut::Tile(_) => self.cover_pyramid(grid),
        };
        tiles.sort_by_key(|tile| (core::cmp::Reverse(tile.level), grid.rank(*tile)));
        tiles
    }

    fn cover_pyramid(&mut self, grid: &TileGrid) -> Vec<Tile> {
        let mut chosen = Vec::new();
        for level in 0..grid.coarsest() {
            let mut wanted = vec![false; grid.tiles_in_level(level) as usize];
            for cell in grid
                .tiles_of(0)
                .filter(|cell| self.level(grid, *cell) == level)
            {
                wanted[grid.rank(grid.tile_over(cell, level)) as usize] = true;
            }
            for cell in grid.tiles_of(0) {
                if wanted[grid.rank(grid.tile_over(cell, level)) as usize] {
                    self.refine(grid, cell, level);
                }
            }
            let ranks = (0..).zip(&wanted).filter(|(_, wanted)| **wanted);
            chosen.extend(ranks.map(|(rank, _)| grid.tile_at(level, rank)));
        }
        chosen.extend(grid.tiles_of(grid.coarsest()));
        chosen
    }
}

/// Pixels of tiles at their own levels.
#[must_use]
pub fn pixels(grid: &TileGrid, tiles: &[Tile]) -> u64 {
    tiles.iter().map(|tile| grid.tile_pixels(*tile)).sum()
}

/// Number of tiles of each level, finest first.
#[must_use]
pub fn histogram(grid: &TileGrid, tiles: &[Tile]) -> Vec<u32> {
    let mut counts = vec![0; usize::from(grid.levels)];
    tiles
        .iter()
        .for_each(|tile| counts[usize::from(tile.level)] += 1);
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::surface::Surface;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_cell_is_shown_at_its_level_or_finer(
            needs in proptest::collection::vec(0u8..5, 6 * 16 * 16),
        ) {
            let grid = TileGrid::new(Surface::cube(1024), Cut::Tile(64), 5, 2).unwrap();
            let mut needs = needs.into_iter();
            let wanted = LevelMap::from_cells(&grid, |_| needs.next().unwrap());
            let mut map = wanted.clone();
            let tiles = map.cover(&grid);
            for cell in grid.tiles_of(0) {
                let shown = (0..5).find(|&l| tiles.contains(&grid.tile_over(cell, l))).unwrap();
                prop_assert!(shown <= wanted.level(&grid, cell));
                prop_assert_eq!(shown, map.level(&grid, cell));
            }
            let mut unique = tiles.clone();
            unique.dedup();
            prop_assert_eq!(unique.len(), tiles.len());
        }
    }
}
