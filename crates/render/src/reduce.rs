//! How does a tile look from one level further away?
//!
//! A minified view, or the soft border of a fine tile, shows a fine tile at a coarser level's
//! spacing. The box average is made once, when the tile arrives, for every later frame to read.

use foveal_core::asset::picture::{Picture, plane_size};
use foveal_core::asset::tile_grid::{Cut, Tile, TileGrid};

/// One plane of a tile at some spacing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Samples {
    /// Columns and rows.
    pub(crate) size: [u32; 2],
    /// Which sample of the level's lattice the first one is, counted from the start of the segment
    /// (see [`crate::params::TileParams::segment`]).
    pub(crate) first: [u32; 2],
    /// Codes, row by row.
    pub(crate) codes: Vec<u8>,
}

/// Plane `p` of `tile`, then its averages at the spacing of every coarser level but the coarsest.
#[must_use]
pub(crate) fn pyramid(grid: &TileGrid, tile: Tile, picture: &Picture, p: usize) -> Vec<Samples> {
    let segment_origin = match grid.cut {
        Cut::Tile(_) => [0, 0],
        Cut::Grid(_) => grid.origin(tile),
    };
    let origin = grid.origin(tile);
    let pitch = grid.scale(tile.level) * if p == 0 { 1 } else { 2 };
    let mut all = vec![Samples {
        size: plane_size(picture.width, picture.height, p),
        first: [0, 1].map(|k| (origin[k] - segment_origin[k]) / pitch),
        codes: picture.planes[p].clone(),
    }];
    for _ in tile.level + 1..grid.coarsest() {
        let next = reduce(&all[all.len() - 1], grid.ratio);
        all.push(next);
    }
    all
}

/// The averages of `ratio` x `ratio` neighbours, rounded; samples that the tile lacks do not count.
#[must_use]
pub(crate) fn reduce(from: &Samples, ratio: u32) -> Samples {
    let first = from.first.map(|f| f / ratio);
    let size = [0, 1].map(|k| (from.first[k] + from.size[k]).div_ceil(ratio) - first[k]);
    let mut codes = Vec::with_capacity(size[0] as usize * size[1] as usize);
    for y in 0..size[1] {
        let rows = covered(from, 1, (first[1] + y) * ratio, ratio);
        for x in 0..size[0] {
            let columns = covered(from, 0, (first[0] + x) * ratio, ratio);
            let count = (rows.len() * columns.len()) as u32;
            let mut sum = count / 2;
            for row in rows.clone() {
                let line = &from.codes[row * from.size[0] as usize..];
                sum += line[columns.clone()]
                    .iter()
                    .map(|&c| u32::from(c))
                    .sum::<u32>();
            }
            codes.push((sum / count) as u8);
        }
    }
    Samples { size, first, codes }
}

/// The samples of axis `k` in [start, start + ratio) of the lattice, counted from the tile's first.
fn covered(from: &Samples, k: usize, start: u32, ratio: u32) -> std::ops::Range<usize> {
    let low = start.max(from.first[k]) - from.first[k];
    let high = (start + ratio).min(from.first[k] + from.size[k]) - from.first[k];
    low as usize..high as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reduced_ramp_is_the_ramp_at_its_new_spacing() {
        let ramp = Samples {
            size: [8, 2],
            first: [4, 0],
            codes: (0..16).map(|i| (i % 8) * 10).collect(),
        };
        let half = reduce(&ramp, 2);
        assert_eq!((half.size, half.first), ([4, 1], [2, 0]));
        assert_eq!(half.codes, [5, 25, 45, 65]);
    }

    #[test]
    fn what_sticks_out_of_a_tile_is_not_averaged() {
        let odd = Samples {
            size: [3, 1],
            first: [1, 0],
            codes: vec![10, 20, 40],
        };
        let half = reduce(&odd, 2);
        assert_eq!((half.size, half.first), ([2, 1], [0, 0]));
        assert_eq!(half.codes, [10, 30]);
    }
}
