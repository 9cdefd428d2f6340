//! How does a tile look at the next coarser level's spacing?
//!
//! A minified view, or the soft border of a fine tile, shows a fine tile at a coarser level's
//! spacing. The box average is made once, when the tile arrives, for every later frame to read: of
//! luma as light, as the coarser levels themselves were made.

use crate::tiles::samples::{Extent, Samples, reductions};
use crate::twin::halve_tiles::halved;
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::perception::measures::luma_light::LumaLight;
use foveal_core::view::picture::{Colour, Picture};

/// Plane `p` of `tile`, then its averages at the spacing of every coarser level but the coarsest.
#[must_use]
pub(crate) fn pyramid(
    grid: &TileGrid,
    tile: Tile,
    picture: &Picture,
    p: usize,
    colour: Colour,
) -> Vec<Samples> {
    let mut all = vec![Samples {
        extent: Extent::of(grid, tile, p),
        codes: picture.planes[p].clone(),
    }];
    let table = LumaLight::of(colour);
    for _ in 0..reductions(grid, tile) {
        let finer = &all[all.len() - 1];
        all.push(match p {
            0 => reduce(
                finer,
                grid.ratio,
                |c| table.light(c),
                |mean| table.code(mean),
            ),
            _ => reduce(finer, grid.ratio, i32::from, |mean| mean as u8),
        });
    }
    all
}

/// The averages of `ratio` x `ratio` neighbours, rounded, of what codes stand for; samples that the
/// tile lacks do not count.
fn reduce(
    from: &Samples,
    ratio: u32,
    value: impl Fn(u8) -> i32,
    code: impl Fn(i32) -> u8,
) -> Samples {
    let Extent { first, size } = from.extent;
    let is_even = |side: &u32| side.is_multiple_of(2);
    if ratio == 2 && first.iter().chain(&size).all(is_even) {
        return halved_by_pairs(from, value, code);
    }
    halved(from, ratio, value, code)
}

/// The same, several times as fast, where every average is of two pairs, one below the other.
fn halved_by_pairs(from: &Samples, value: impl Fn(u8) -> i32, code: impl Fn(i32) -> u8) -> Samples {
    let columns = from.extent.size[0] as usize;
    let mut codes = Vec::with_capacity(from.codes.len() / 4);
    for rows in from.codes.chunks_exact(2 * columns) {
        let (above, below) = rows.split_at(columns);
        let squares = above.chunks_exact(2).zip(below.chunks_exact(2));
        codes.extend(squares.map(|(above, below)| {
            let sum = value(above[0]) + value(above[1]) + value(below[0]) + value(below[1]);
            code((sum + 2) / 4)
        }));
    }
    Samples {
        extent: from.extent.reduced(2),
        codes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reduced_ramp_is_the_ramp_at_its_new_spacing() {
        let ramp = Samples {
            extent: Extent {
                first: [4, 0],
                size: [8, 2],
            },
            codes: (0..16).map(|i| (i % 8) * 10).collect(),
        };
        let half = reduce(&ramp, 2, i32::from, |mean| mean as u8);
        assert_eq!((half.extent.size, half.extent.first), ([4, 1], [2, 0]));
        assert_eq!(half.codes, [5, 25, 45, 65]);
    }

    #[test]
    fn what_sticks_out_of_a_tile_is_not_averaged() {
        let odd = Samples {
            extent: Extent {
                first: [1, 0],
                size: [3, 1],
            },
            codes: vec![10, 20, 40],
        };
        let half = reduce(&odd, 2, i32::from, |mean| mean as u8);
        assert_eq!((half.extent.size, half.extent.first), ([2, 1], [0, 0]));
        assert_eq!(half.codes, [10, 30]);
    }

    #[test]
    fn pairs_have_the_means_that_any_squares_have() {
        use foveal_core::view::picture::Matrix;
        let table = LumaLight::of(Colour {
            matrix: Matrix::Bt709,
            full_range: false,
            chroma_left: false,
        });
        let mut state = 1_u32;
        let mut below = |bound: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % bound
        };
        for _ in 0..50 {
            let size = [0; 2].map(|_| 2 + 2 * below(20));
            let first = [0; 2].map(|_| 2 * below(9));
            let codes = (0..size[0] * size[1]).map(|_| below(256) as u8).collect();
            let extent = Extent { first, size };
            let from = Samples { extent, codes };
            let (light, code) = (|c| table.light(c), |mean| table.code(mean));
            let (plain, same) = (i32::from, |mean| mean as u8);
            assert_eq!(
                halved_by_pairs(&from, light, code),
                halved(&from, 2, light, code)
            );
            assert_eq!(
                halved_by_pairs(&from, plain, same),
                halved(&from, 2, plain, same)
            );
        }
    }

    #[test]
    fn a_fine_tile_seen_from_afar_is_as_bright_as_its_texture() {
        use foveal_core::content::video::grid::tile_grid::Cut;
        use foveal_core::view::picture::Matrix;
        use foveal_core::view::surface::Surface;
        let grid = TileGrid::new(Surface::cube(64), Cut::Tile(16), 3, 2).unwrap();
        let colour = Colour {
            matrix: Matrix::Bt709,
            full_range: true,
            chroma_left: false,
        };
        let mut stripes = Picture::filled(16, 16, [40, 128, 128]);
        stripes.planes[0]
            .iter_mut()
            .step_by(2)
            .for_each(|code| *code = 200);
        let table = LumaLight::of(colour);
        let mean = f64::from(table.light(40) + table.light(200)) / 2.0;
        let half = &pyramid(&grid, grid.tile_at(0, 0), &stripes, 0, colour)[1];
        for code in &half.codes {
            let off = f64::from(table.light(*code)) / mean - 1.0;
            assert!(off.abs() < 0.02, "{code}");
        }
    }
}
