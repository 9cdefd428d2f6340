//! Which colour has each sample, from whatever tiles were decoded?
//!
//! The sampling of Kastner 2016, section 4.1.3: a pixel-based access to the decoded tile of each
//! sample, at the level that the tile has. Here a sample is the mean of what a pixel of the view
//! covers there, or of what the sample stands for, so that what is finer does not alias.

use super::picture::Picture;
use super::tile_grid::{Tile, TileGrid};
use crate::view::eye_view::EyeView;
use glam::DVec3;
use std::collections::BTreeMap;

/// Decoded tiles, the finest over every cell.
#[derive(Clone, Debug)]
pub struct Gather<'a> {
    grid: &'a TileGrid,
    /// For every cell, by rank, its tile and what it shows.
    shown: Vec<Option<(Tile, &'a Picture)>>,
    /// Level-0 pixels under a pixel of the view, on a side.
    footprint: f64,
}

impl<'a> Gather<'a> {
    /// Tiles to gather from; a picture must have the size of its tile.
    #[must_use]
    pub fn new(grid: &'a TileGrid, tiles: &'a BTreeMap<Tile, Picture>, footprint: f64) -> Self {
        let finest = |cell: Tile| {
            let mut over = (0..grid.levels).map(|level| grid.tile_over(cell, level));
            over.find_map(|tile| tiles.get_key_value(&tile))
                .map(|(tile, picture)| (*tile, picture))
        };
        Self {
            grid,
            shown: grid.tiles_of(0).map(finest).collect(),
            footprint,
        }
    }

    /// The colours of samples of a view, whose `places` count from the pixel at `corner`: each the
    /// mean of a square as many pixels of the view wide as `across` says. A sample out of view
    /// takes the colour of the nearest pixel in view, as pixels there may be nearest to it.
    #[must_use]
    pub fn codes(
        &self,
        view: &EyeView,
        corner: [i32; 2],
        places: &[[u16; 2]],
        across: impl Fn([u16; 2]) -> f64,
    ) -> Vec<u32> {
        let ray_from_pixel = view.ray_from_pixel();
        let code = |place: &[u16; 2]| {
            let [x, y] = [0, 1].map(|k| {
                let pixel = corner[k] + i32::from(place[k]);
                f64::from(pixel.clamp(0, view.size[k] as i32 - 1)) + 0.5
            });
            let found = self
                .grid
                .surface
                .locate(ray_from_pixel * DVec3::new(x, y, 1.0));
            found.map_or(0, |(face, at)| self.code_at(face, at, across(*place)))
        };
        places.iter().map(code).collect()
    }

    /// Y, U and V in the low three bytes, lowest first, at a place of a face in level-0 pixels: the
    /// mean of a square of `across` pixels of the view;
    /// places beyond the border take the nearest tile's border. 0 where no tile is.
    #[must_use]
    pub fn code_at(&self, face: u32, place: [f64; 2], across: f64) -> u32 {
        let cell = self.grid.cell_at(face, place);
        let Some((tile, picture)) = self.shown[self.grid.rank(cell) as usize] else {
            return 0;
        };
        let scale = f64::from(self.grid.scale(tile.level));
        let from = self.grid.origin(tile);
        let at = [0, 1].map(|k| (place[k] - f64::from(from[k])) / scale);
        let across = (across * self.footprint / scale).max(1.0);
        let luma = mean(picture, 0, at, across);
        let [u, v] = [1, 2].map(|p| mean(picture, p, at.map(|k| k / 2.0), across / 2.0));
        luma | u << 8 | v << 16
    }
}

/// Mean of the samples whose centres lie in a square of `across` round a place of a plane, at least
/// one.
fn mean(picture: &Picture, plane: usize, at: [f64; 2], across: f64) -> u32 {
    let size = picture.plane_size(plane);
    let count = libm::round(across).max(1.0);
    let [columns, rows] = [0, 1].map(|k| {
        let last = f64::from(size[k] - 1);
        let first = libm::floor(at[k] - (count - 1.0) / 2.0);
        let clamped = |place: f64| place.clamp(0.0, last) as usize;
        clamped(first)..=clamped(first + count - 1.0)
    });
    let (mut sum, mut of) = (0, 0);
    for y in rows {
        let line = &picture.planes[plane][y * size[0] as usize..][..size[0] as usize];
        for code in &line[columns.clone()] {
            sum += u32::from(*code);
            of += 1;
        }
    }
    (sum + of / 2) / of
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::tile_grid::Cut;
    use crate::view::surface::{Screen, Surface};

    fn grid() -> TileGrid {
        let flat = Surface::flat([200, 120], Screen::default());
        TileGrid::new(flat, Cut::Grid([4, 3]), 3, 4).unwrap()
    }

    /// Tiles of a picture whose luma is its column, at levels that take turns.
    fn ramps(grid: &TileGrid) -> BTreeMap<Tile, Picture> {
        let tiles = grid
            .tiles_of(0)
            .map(|cell| grid.tile_over(cell, (cell.x % 3) as u8));
        let picture = |tile: Tile| {
            let [w, h] = grid.tile_size(tile);
            let mut picture = Picture::filled(w, h, [0, 100, 150]);
            for (at, code) in (0..).zip(&mut picture.planes[0]) {
                let column = f64::from(at % w) + 0.5;
                let place = column * f64::from(grid.scale(tile.level));
                *code = (f64::from(grid.origin(tile)[0]) + place) as u8;
            }
            picture
        };
        tiles.map(|tile| (tile, picture(tile))).collect()
    }

    #[test]
    fn a_sample_has_the_colour_of_its_place_to_a_pixel_of_its_level() {
        let grid = grid();
        let tiles = ramps(&grid);
        for footprint in [1.0, 2.0, 3.0, 7.0] {
            let gather = Gather::new(&grid, &tiles, footprint);
            for x in 0..200 {
                let place = [f64::from(x) + 0.5, 60.2];
                let cell = grid.cell_at(0, place);
                let scale = f64::from(grid.scale((cell.x % 3) as u8));
                let code = gather.code_at(0, place, 1.0);
                let away = (f64::from(code & 255) - place[0]).abs();
                assert!(
                    away <= footprint.max(scale) + 1.0,
                    "{x} {footprint}: {away}"
                );
                assert_eq!(code >> 8, 100 | 150 << 8);
            }
        }
    }

    #[test]
    fn a_pixel_of_the_view_is_one_pixel_of_content_at_its_own_density() {
        let grid = grid();
        let tiles = ramps(&grid);
        let gather = Gather::new(&grid, &tiles, 1.0);
        for x in 0..50 {
            assert_eq!(gather.code_at(0, [f64::from(x) + 0.5, 3.5], 1.0) & 255, x);
        }
    }

    #[test]
    fn no_tile_is_no_colour_and_no_place_is_out_of_bounds() {
        let grid = grid();
        let none = BTreeMap::new();
        assert_eq!(
            Gather::new(&grid, &none, 1.0).code_at(0, [3.0, 3.0], 1.0),
            0
        );
        let tiles = ramps(&grid);
        let gather = Gather::new(&grid, &tiles, 40.0);
        for place in [[-9.0, -9.0], [199.99, 119.99], [500.0, 500.0], [0.0, 119.0]] {
            assert_ne!(gather.code_at(0, place, 1.0), 0);
        }
    }
}
