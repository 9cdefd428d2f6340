//! Which samples of a level does a plane of a tile hold?

use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::view::picture::plane_size;

/// A rectangle of a level's lattice of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Extent {
    /// Column and row of the first sample, counted from the start of the segment (see
    /// [`crate::params::TileParams::segment`]).
    pub(crate) first: [u32; 2],
    /// Columns and rows.
    pub(crate) size: [u32; 2],
}

impl Extent {
    /// Of plane `p` of a tile.
    pub(crate) fn of(grid: &TileGrid, tile: Tile, p: usize) -> Self {
        let origin = grid.origin(tile);
        let segment_origin = match grid.cut {
            Cut::Tile(_) => [0, 0],
            Cut::Grid(_) => origin,
        };
        let pitch = grid.scale(tile.level) * if p == 0 { 1 } else { 2 };
        let [width, height] = grid.tile_size(tile);
        Self {
            first: [0, 1].map(|k| (origin[k] - segment_origin[k]) / pitch),
            size: plane_size(width, height, p),
        }
    }

    /// What is left of it where samples are `ratio` times as far apart.
    pub(crate) fn reduced(self, ratio: u32) -> Self {
        let first = self.first.map(|first| first / ratio);
        let size = [0, 1].map(|k| (self.first[k] + self.size[k]).div_ceil(ratio) - first[k]);
        Self { first, size }
    }
}

/// One plane of a tile at some spacing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Samples {
    pub(crate) extent: Extent,
    /// Codes, row by row.
    pub(crate) codes: Vec<u8>,
}

/// How often a tile is reduced: to the spacing of every coarser level but the coarsest, which is
/// always there.
pub(crate) fn reductions(grid: &TileGrid, tile: Tile) -> u32 {
    u32::from(grid.coarsest().saturating_sub(tile.level + 1))
}
