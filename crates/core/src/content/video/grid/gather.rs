//! Which colour has each sample, from whatever tiles were decoded?
//!
//! The sampling of Kastner 2016, section 4.1.3: a pixel-based access to the decoded tile of each
//! sample, at the level that the tile has. Here a sample is the mean of what a pixel of the view
//! covers there, or of what the sample stands for, so that what is finer does not alias; and what
//! is coarser can be interpolated, so that its texels are not seen.

use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::view::eye_view::EyeView;
use crate::view::picture::Picture;
use glam::DVec3;
use std::collections::BTreeMap;

/// The code of a sample that nothing is known of: Y 0, no colour.
const BLACK: u32 = 128 << 8 | 128 << 16;

/// Decoded tiles, the finest over every cell.
#[derive(Clone, Debug)]
pub struct Gather<'a> {
    grid: &'a TileGrid,
    /// For every cell, by rank, its tile and what it shows.
    shown: Vec<Option<(Tile, &'a Picture)>>,
    /// Level-0 pixels under a pixel of the view, on a side.
    footprint: f64,
    /// Whether texels that are larger than what is asked for are interpolated.
    interpolates: bool,
}

impl<'a> Gather<'a> {
    /// Tiles to gather from; a picture must have the size of its tile.
    #[must_use]
    pub fn new(
        grid: &'a TileGrid,
        tiles: &'a BTreeMap<Tile, Picture>,
        footprint: f64,
        interpolates: bool,
    ) -> Self {
        let finest = |cell: Tile| {
            let mut over = (0..grid.levels).map(|level| grid.tile_over(cell, level));
            over.find_map(|tile| tiles.get_key_value(&tile))
                .map(|(tile, picture)| (*tile, picture))
        };
        Self {
            grid,
            shown: grid.tiles_of(0).map(finest).collect(),
            footprint,
            interpolates,
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
            found.map_or(BLACK, |(face, at)| self.code_at(face, at, across(*place)))
        };
        places.iter().map(code).collect()
    }

    /// Y, U and V in the low three bytes, lowest first, at a place of a face in level-0 pixels: the
    /// mean of a square of `across` pixels of the view;
    /// places beyond the border take the nearest tile's border. Black where no tile is.
    #[must_use]
    pub fn code_at(&self, face: u32, place: [f64; 2], across: f64) -> u32 {
        let side = across * self.footprint;
        if self.tile_at(face, place).is_none() {
            return BLACK;
        }
        let [y, u, v] = [0, 1, 2].map(|plane| self.sample(face, place, plane, side));
        y | u << 8 | v << 16
    }

    /// The mean of one plane over a square `side` level-0 pixels wide.
    fn sample(&self, face: u32, place: [f64; 2], plane: usize, side: f64) -> u32 {
        let Some((tile, picture)) = self.tile_at(face, place) else {
            return 0;
        };
        let texel = self.texel(tile, plane);
        if !self.interpolates || side >= 1.5 * texel {
            return self.mean_at(face, place, plane, side);
        }
        let from = self.grid.origin(tile).map(f64::from);
        let along = [0, 1].map(|k| (place[k] - from[k]) / texel - 0.5);
        let low = along.map(libm::floor);
        let [width, height] = picture.plane_size(plane);
        let inside = low[0] >= 0.0
            && low[1] >= 0.0
            && low[0] + 1.0 < f64::from(width)
            && low[1] + 1.0 < f64::from(height);
        let taps = if inside {
            let first = low[1] as usize * width as usize + low[0] as usize;
            let rows = [first, first + width as usize];
            rows.map(|at| [0, 1].map(|dx| f64::from(picture.planes[plane][at + dx])))
        } else {
            // Of whichever tiles they are.
            let [columns, rows] =
                [0, 1].map(|k| [0.5, 1.5].map(|half| from[k] + (low[k] + half) * texel));
            let texel_at = |x, y| f64::from(self.mean_at(face, self.inside([x, y]), plane, texel));
            rows.map(|y| columns.map(|x| texel_at(x, y)))
        };
        let [x, y] = [0, 1].map(|k| along[k] - low[k]);
        let [upper, lower] = taps.map(|[left, right]| left + (right - left) * x);
        libm::round(upper + (lower - upper) * y) as u32
    }

    /// The place on the surface nearest to one that may lie beyond its borders.
    fn inside(&self, place: [f64; 2]) -> [f64; 2] {
        let surface = &self.grid.surface;
        let place = surface.closed(place);
        [0, 1].map(|k| {
            let last = (f64::from(surface.size[k]) - 0.5).max(0.5);
            place[k].clamp(0.5, last)
        })
    }

    /// Level-0 pixels that a texel of a plane of this tile covers, on a side.
    fn texel(&self, tile: Tile, plane: usize) -> f64 {
        f64::from(self.grid.scale(tile.level)) * if plane == 0 { 1.0 } else { 2.0 }
    }

    /// The mean of the texels of one tile in that square.
    fn mean_at(&self, face: u32, place: [f64; 2], plane: usize, side: f64) -> u32 {
        let Some((tile, picture)) = self.tile_at(face, place) else {
            return 0;
        };
        let texel = self.texel(tile, plane);
        let from = self.grid.origin(tile);
        let at = [0, 1].map(|k| (place[k] - f64::from(from[k])) / texel);
        mean(picture, plane, at, (side / texel).max(1.0))
    }

    fn tile_at(&self, face: u32, place: [f64; 2]) -> Option<(Tile, &'a Picture)> {
        let cell = self.grid.cell_at(face, place);
        self.shown[self.grid.rank(cell) as usize]
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
    use crate::content::video::grid::tile_grid::Cut;
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
            let gather = Gather::new(&grid, &tiles, footprint, false);
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
        let gather = Gather::new(&grid, &tiles, 1.0, false);
        for x in 0..50 {
            assert_eq!(gather.code_at(0, [f64::from(x) + 0.5, 3.5], 1.0) & 255, x);
        }
    }

    #[test]
    fn interpolated_coarse_texels_are_not_seen_and_the_finest_stay_as_they_are() {
        let grid = grid();
        let tiles = ramps(&grid);
        let gather = Gather::new(&grid, &tiles, 1.0, true);
        for x in 8..192 {
            let place = [f64::from(x) + 0.5, 60.5];
            let code = gather.code_at(0, place, 1.0) & 255;
            // To the middle of the texel at a border with another level, else to a rounding.
            let coarse = (x / 50) % 3 > 0;
            let at_border = (x + 8) % 50 < 16;
            let most = if coarse && at_border { 8 } else { 1 };
            assert!(code.abs_diff(x) <= most, "{x}: {code}");
        }
    }

    #[test]
    fn no_tile_is_black_and_no_place_is_out_of_bounds() {
        let grid = grid();
        let none = BTreeMap::new();
        assert_eq!(
            Gather::new(&grid, &none, 1.0, true).code_at(0, [3.0, 3.0], 1.0),
            BLACK
        );
        let tiles = ramps(&grid);
        let gather = Gather::new(&grid, &tiles, 40.0, true);
        for place in [[-9.0, -9.0], [199.99, 119.99], [500.0, 500.0], [0.0, 119.0]] {
            assert_ne!(gather.code_at(0, place, 1.0), 0);
        }
    }
}
