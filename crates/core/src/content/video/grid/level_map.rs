//! At which level is each part of the picture shown, and which tiles does that take?

use crate::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use std::collections::BTreeSet;

/// A level for every cell of a grid. Both eyes look at the same place, so what is chosen for a
/// cell of one eye is chosen for the same cell of the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelMap {
    /// Face-major, then rows, then columns: the rank of the left eye's cell.
    levels: Vec<u8>,
}

impl LevelMap {
    /// All cells at one level.
    #[must_use]
    pub fn filled(grid: &TileGrid, level: u8) -> Self {
        Self {
            levels: vec![level; grid.tiles_of_left_eye(0).count()],
        }
    }

    /// The level that `level_of` gives each cell; it is asked for those of the left eye.
    #[must_use]
    pub fn from_cells(grid: &TileGrid, level_of: impl FnMut(Tile) -> u8) -> Self {
        Self {
            levels: grid.tiles_of_left_eye(0).map(level_of).collect(),
        }
    }

    /// These levels, by rank of the left eye's cell; one for each.
    pub(crate) fn by_rank(levels: Vec<u8>) -> Self {
        Self { levels }
    }

    /// Levels by rank of the left eye's cell.
    #[must_use]
    pub fn levels(&self) -> &[u8] {
        &self.levels
    }

    /// The level of a cell.
    #[must_use]
    pub fn level(&self, grid: &TileGrid, cell: Tile) -> u8 {
        self.levels[grid.rank(grid.for_left_eye(cell)) as usize]
    }

    /// Makes a cell, for both eyes, at least as fine as `level`.
    pub fn refine(&mut self, grid: &TileGrid, cell: Tile, level: u8) {
        let at = &mut self.levels[grid.rank(grid.for_left_eye(cell)) as usize];
        *at = level.min(*at);
    }

    /// Shows no cell coarser than another map of the same grid does.
    pub fn refine_to(&mut self, other: &Self) {
        for (level, other) in self.levels.iter_mut().zip(&other.levels) {
            *level = (*level).min(*other);
        }
    }

    /// The levels that are shown, which the tiles of neighbours may make finer.
    #[must_use]
    pub(crate) fn covered(&self, grid: &TileGrid) -> Self {
        let mut shown = self.clone();
        let _ = shown.cover(grid);
        shown
    }

    /// Number of the left eye's cells whose level differs.
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
        loop {
            let chosen = self.cover_as_needed(grid);
            // Every round spends fewer pixels than the one before, so there is a last one.
            if !self.refine_where_cheaper(grid, &chosen) {
                return chosen;
            }
        }
    }

    /// The tiles that show every cell at its level, or finer where a chosen tile covers it anyway.
    fn cover_as_needed(&mut self, grid: &TileGrid) -> Vec<Tile> {
        let mut chosen = Vec::new();
        for level in 0..grid.coarsest() {
            let at_level = (0..).zip(&self.levels).filter(|(_, of)| **of == level);
            let cells = at_level.flat_map(|(rank, _)| grid.for_every_eye(grid.tile_at(0, rank)));
            let wanted: BTreeSet<u32> = cells
                .map(|cell| grid.rank(grid.tile_over(cell, level)))
                .collect();
            for tile in wanted.into_iter().map(|rank| grid.tile_at(level, rank)) {
                grid.cells_under(tile)
                    .for_each(|cell| self.refine(grid, cell, level));
                chosen.push(tile);
            }
        }
        chosen.extend(grid.tiles_of(grid.coarsest()));
        chosen
    }

    /// At the right and bottom border tiles are cut off, and a few thin finer tiles can be fewer
    /// pixels than the one coarser tile over them. Returns whether that was so anywhere.
    fn refine_where_cheaper(&mut self, grid: &TileGrid, chosen: &[Tile]) -> bool {
        let uncut = grid.tile_pixels(grid.tile_at(0, 0));
        let coarsest = grid.coarsest();
        let mut changed = false;
        for tile in chosen
            .iter()
            .filter(|tile| (1..coarsest).contains(&tile.level))
        {
            if grid.tile_pixels(*tile) >= uncut {
                continue;
            }
            let served: Vec<Tile> = grid
                .tiles_of(0)
                .filter(|cell| self.level(grid, *cell) == tile.level)
                .filter(|cell| grid.tile_over(*cell, tile.level) == *tile)
                .collect();
            // Of one eye; the other's tiles are the same size.
            let cost = |level: u8| {
                let over = served.iter().map(|cell| grid.tile_over(*cell, level));
                let tiles: BTreeSet<Tile> = over.collect();
                tiles
                    .iter()
                    .map(|tile| grid.tile_pixels(*tile))
                    .sum::<u64>()
            };
            let best = (0..tile.level).rev().min_by_key(|level| cost(*level));
            if let Some(level) = best.filter(|level| cost(*level) < grid.tile_pixels(*tile)) {
                served
                    .iter()
                    .for_each(|cell| self.refine(grid, *cell, level));
                changed |= !served.is_empty();
            }
        }
        changed
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
    use crate::view::surface::{Screen, Surface};
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

            #[test]
            fn a_cover_never_takes_more_than_all_finest_tiles_and_the_coarsest_level(
                needs in proptest::collection::vec(0u8..4, 400),
                width in 130u32..700, height in 130u32..500,
            ) {
                let surface = Surface::flat([width, height], Screen::default());
                let grid = TileGrid::new(surface, Cut::Tile(64), 4, 2).unwrap();
                let mut needs = needs.into_iter().cycle();
                let wanted = LevelMap::from_cells(&grid, |_| needs.next().unwrap());
                let mut map = wanted.clone();
                let tiles = map.cover(&grid);
                let whole = pixels(&grid, &LevelMap::filled(&grid, 0).cover(&grid));
                prop_assert!(pixels(&grid, &tiles) <= whole);
                for cell in grid.tiles_of(0) {
                    prop_assert!(map.level(&grid, cell) <= wanted.level(&grid, cell));
                    prop_assert!(tiles.contains(&grid.tile_over(cell, map.level(&grid, cell))));
                }
            }
    }
}
