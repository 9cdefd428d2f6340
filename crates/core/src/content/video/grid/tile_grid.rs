//! Which tiles does a picture consist of, and which pixels does each hold?

use crate::units::{Radians, counted};
use crate::view::surface::{Projection, Surface};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How the picture is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cut {
    /// A pyramid: tiles of this many pixels on a side at their own level, so that a tile covers
    /// `ratio^level` times as much on a side. The coarsest level is one tile per face.
    Tile(u32),
    /// A grid: columns and rows per face, the same regions at every level, sizes rounded up, as
    /// Kastner (2016) cuts.
    Grid([u32; 2]),
}

impl Cut {
    /// The pyramid for a surface: tiles of 256 px for spheres and for flat content from 12K on,
    /// 512 px for flat content below, to keep streams few; 128 px below 2K (around, for a
    /// sphere), where larger ones would be half the picture. `docs/decisions/0003` has the
    /// measurements.
    #[must_use]
    pub fn pyramid_for(surface: &Surface) -> Self {
        match (surface.projection, surface.size[0]) {
            (Projection::Cube, 500..)
            | (Projection::Equirect, 2_000..)
            | (Projection::Flat, 12_000..) => Self::Tile(256),
            (Projection::Flat, 2_000..) => Self::Tile(512),
            _ => Self::Tile(128),
        }
    }
}

/// One tile of a picture, without time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Tile {
    /// Level, 0 is the finest.
    pub level: u8,
    /// Face, 0 for flat content.
    pub face: u8,
    /// Column within the face.
    pub x: u16,
    /// Row within the face.
    pub y: u16,
}

/// The tiles of every level of a surface.
///
/// A *cell* is a level-0 tile: the finest piece that a level is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileGrid {
    /// What the tiles cover.
    pub surface: Surface,
    /// How they are cut.
    pub cut: Cut,
    /// Number of levels, at least 1.
    pub levels: u8,
    /// Linear ratio between neighbouring levels: 2 or 4.
    pub ratio: u32,
}

/// Why a tile grid cannot be.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GridError {
    /// A side of the picture is 0 or beyond [`MAX_SIDE`].
    #[error("the picture is {0}x{1} pixels; each side must be 1 to {MAX_SIDE}")]
    Size(u32, u32),
    /// Number of levels out of range.
    #[error("{0} levels; give 1 to {MAX_LEVELS}")]
    Levels(u8),
    /// Ratio of levels is not 2 or 4.
    #[error("level ratio {0}; it must be 2 or 4")]
    Ratio(u32),
    /// Tile size out of range or odd.
    #[error("tiles of {}; they must have an even number of 16 to 4096", counted(.0, "pixel"))]
    Tile(u32),
    /// Grid out of range.
    #[error("a grid of {0}x{1}; each must be 1 to 256 and leave cells of at least 2 pixels")]
    Grid(u32, u32),
    /// Eyes out of range.
    #[error("pictures for {0} eyes; there must be 1 or 2")]
    Eyes(u8),
    /// Faces of a cube out of range.
    #[error("a cube of {}; it must have 6, or 4 without top and bottom", counted(.0, "face"))]
    Faces(u8),
    /// More tiles than a pack can address.
    #[error("{0} tiles; at most {MAX_TILES} can be addressed: use larger tiles")]
    Tiles(u64),
}

/// Longest side of a face in pixels.
pub const MAX_SIDE: u32 = 1 << 16;
/// Most levels of a pack.
pub const MAX_LEVELS: u8 = 8;
/// Most tiles of all levels and faces.
pub const MAX_TILES: u64 = 1 << 20;

impl TileGrid {
    /// A checked grid; see [`GridError`] for what is refused.
    pub fn new(surface: Surface, cut: Cut, levels: u8, ratio: u32) -> Result<Self, GridError> {
        let grid = Self {
            surface,
            cut,
            levels,
            ratio,
        };
        grid.check()?;
        Ok(grid)
    }

    /// Whether every field is in range; a grid read from a pack must pass this before use.
    pub fn check(&self) -> Result<(), GridError> {
        let [w, h] = self.surface.size;
        if w == 0 || h == 0 || w > MAX_SIDE || h > MAX_SIDE {
            return Err(GridError::Size(w, h));
        }
        if !(1..=2).contains(&self.surface.eyes) {
            return Err(GridError::Eyes(self.surface.eyes));
        }
        if ![4, 6].contains(&self.surface.cube_faces) {
            return Err(GridError::Faces(self.surface.cube_faces));
        }
        if self.levels == 0 || self.levels > MAX_LEVELS {
            return Err(GridError::Levels(self.levels));
        }
        if self.ratio != 2 && self.ratio != 4 {
            return Err(GridError::Ratio(self.ratio));
        }
        match self.cut {
            Cut::Tile(px) if !(16..=4096).contains(&px) || px % 2 != 0 => {
                return Err(GridError::Tile(px));
            }
            Cut::Grid([c, r]) if !(1..=256).contains(&c) || !(1..=256).contains(&r) => {
                return Err(GridError::Grid(c, r));
            }
            Cut::Grid([c, r]) if w.div_ceil(c) < 2 || h.div_ceil(r) < 2 => {
                return Err(GridError::Grid(c, r));
            }
            _ => {}
        }
        let tiles = (0..self.levels)
            .map(|l| u64::from(self.tiles_in_level(l)))
            .sum();
        if tiles > MAX_TILES {
            return Err(GridError::Tiles(tiles));
        }
        Ok(())
    }

    /// The coarsest level, always resident.
    #[must_use]
    pub fn coarsest(&self) -> u8 {
        self.levels - 1
    }

    /// Number of faces of all eyes.
    #[must_use]
    pub fn faces(&self) -> u32 {
        self.surface.faces()
    }

    /// The tile that shows the left eye what `tile` shows its own.
    #[must_use]
    pub fn for_left_eye(&self, tile: Tile) -> Tile {
        Tile {
            face: (u32::from(tile.face) % self.surface.faces_of_an_eye()) as u8,
            ..tile
        }
    }

    /// What `tile` is to every eye: one tile, or the left eye's and the right eye's.
    pub fn for_every_eye(&self, tile: Tile) -> impl Iterator<Item = Tile> + use<> {
        let (left, step) = (
            self.for_left_eye(tile),
            self.surface.faces_of_an_eye() as u8,
        );
        (0..self.surface.eyes).map(move |eye| Tile {
            face: left.face + eye * step,
            ..left
        })
    }

    /// All tiles of a level that the left eye has, in rank order: the first of [`Self::tiles_of`].
    pub fn tiles_of_left_eye(&self, level: u8) -> impl Iterator<Item = Tile> + '_ {
        let tiles = self.tiles_in_level(level) / u32::from(self.surface.eyes);
        (0..tiles).map(move |rank| self.tile_at(level, rank))
    }

    /// Level-0 pixels under one pixel of `level`, on a side: `ratio^level`.
    #[must_use]
    pub fn scale(&self, level: u8) -> u32 {
        self.ratio.pow(u32::from(level))
    }

    /// Level-0 pixels that a tile of `level` covers on each axis.
    #[must_use]
    pub fn span(&self, level: u8) -> [u32; 2] {
        match self.cut {
            Cut::Tile(_) if level == self.coarsest() => self.surface.size,
            Cut::Tile(px) => [px.saturating_mul(self.scale(level)); 2],
            // Cells begin at even pixels, or chroma would shift by half a sample.
            Cut::Grid([c, r]) => {
                let [w, h] = self.surface.size;
                [
                    w.div_ceil(c).next_multiple_of(2),
                    h.div_ceil(r).next_multiple_of(2),
                ]
            }
        }
    }

    /// Columns and rows of tiles of `level` on one face.
    #[must_use]
    pub fn tiles(&self, level: u8) -> [u32; 2] {
        let span = self.span(level);
        [0, 1].map(|k| self.surface.size[k].div_ceil(span[k]))
    }

    /// Tiles of `level` over all faces.
    #[must_use]
    pub fn tiles_in_level(&self, level: u8) -> u32 {
        let [x, y] = self.tiles(level);
        self.faces() * x * y
    }

    /// Columns and rows of cells on one face.
    #[must_use]
    pub fn cells(&self) -> [u32; 2] {
        self.tiles(0)
    }

    /// Position of a tile in its level: face-major, then rows, then columns.
    #[must_use]
    pub fn rank(&self, tile: Tile) -> u32 {
        let [x, y] = self.tiles(tile.level);
        (u32::from(tile.face) * y + u32::from(tile.y)) * x + u32::from(tile.x)
    }

    /// The tile at a rank of a level; the inverse of [`Self::rank`].
    #[must_use]
    pub fn tile_at(&self, level: u8, rank: u32) -> Tile {
        let [x, y] = self.tiles(level);
        Tile {
            level,
            face: (rank / (x * y)) as u8,
            x: (rank % x) as u16,
            y: (rank / x % y) as u16,
        }
    }

    /// Top left corner of a tile in level-0 pixels of its face.
    #[must_use]
    pub fn origin(&self, tile: Tile) -> [u32; 2] {
        let span = self.span(tile.level);
        [u32::from(tile.x) * span[0], u32::from(tile.y) * span[1]]
    }

    /// Level-0 pixels of the face under a tile: its span, less what lies beyond the border.
    #[must_use]
    pub fn covered(&self, tile: Tile) -> [u32; 2] {
        let (origin, span) = (self.origin(tile), self.span(tile.level));
        [0, 1].map(|k| span[k].min(self.surface.size[k] - origin[k]))
    }

    /// Unit direction of a tile's centre.
    #[must_use]
    pub fn centre(&self, tile: Tile) -> DVec3 {
        let (from, size) = (self.origin(tile), self.covered(tile));
        let place = [0, 1].map(|k| f64::from(from[k]) + f64::from(size[k]) / 2.0);
        self.surface.direction(u32::from(tile.face), place)
    }

    /// Pixels of a tile at its own level, rounded up.
    #[must_use]
    pub fn tile_size(&self, tile: Tile) -> [u32; 2] {
        self.covered(tile)
            .map(|c| c.div_ceil(self.scale(tile.level)))
    }

    /// Pixels of a tile at its own level.
    #[must_use]
    pub fn tile_pixels(&self, tile: Tile) -> u64 {
        let [w, h] = self.tile_size(tile);
        u64::from(w) * u64::from(h)
    }

    /// The largest tile of any level but the coarsest, in pixels (all levels when there is one).
    #[must_use]
    pub fn largest_tile(&self) -> [u32; 2] {
        let first = Tile {
            level: 0,
            face: 0,
            x: 0,
            y: 0,
        };
        self.tile_size(first)
    }

    /// How far outside a coarsest cell the picture is coarser than its own level, at most: a view
    /// that is to be sharp to its borders needs as much beyond them.
    #[must_use]
    pub fn fade(&self) -> Radians {
        let surface = &self.surface;
        let rise = self.scale(self.coarsest()) - 1;
        let pixels = self.blend_pixels() * f64::from(rise);
        if !surface.is_of_planes() {
            return Radians(pixels * surface.pitch());
        }
        let half = f64::from(surface.size[0]) / 2.0;
        Radians(libm::atan(
            pixels * surface.tangents[0] / half * surface.mapping().slope(0.0),
        ))
    }

    /// Level-0 pixels over which the reconstruction lets the footprint of a texel grow by one
    /// level-0 pixel where levels meet: slower costs sharpness, faster shows the border.
    ///
    /// Four, less where the fade from the coarsest level to the finest would not fit into a cell.
    #[must_use]
    pub fn blend_pixels(&self) -> f64 {
        let span = self.span(0);
        let [w, h] = [0, 1].map(|k| f64::from(span[k].min(self.surface.size[k])));
        let rise = f64::from(self.scale(self.coarsest())) - 1.0;
        if rise > 0.0 {
            (w.min(h) / rise).min(4.0)
        } else {
            4.0
        }
    }

    /// The cell at a place of a face in level-0 pixels; places beyond the border go to the nearest.
    #[must_use]
    pub fn cell_at(&self, face: u32, place: [f64; 2]) -> Tile {
        let (span, cells) = (self.span(0), self.cells());
        let index = |k: usize| {
            let cell = libm::floor(place[k] / f64::from(span[k]));
            cell.clamp(0.0, f64::from(cells[k] - 1)) as u16
        };
        Tile {
            level: 0,
            face: face as u8,
            x: index(0),
            y: index(1),
        }
    }

    /// The tile of `level` that covers a cell.
    #[must_use]
    pub fn tile_over(&self, cell: Tile, level: u8) -> Tile {
        let (origin, span) = (self.origin(cell), self.span(level));
        Tile {
            level,
            face: cell.face,
            x: (origin[0] / span[0]) as u16,
            y: (origin[1] / span[1]) as u16,
        }
    }

    /// The cells that a tile covers, row by row.
    pub fn cells_under(&self, tile: Tile) -> impl Iterator<Item = Tile> + use<> {
        let (origin, covered, span) = (self.origin(tile), self.covered(tile), self.span(0));
        let [x, y] =
            [0, 1].map(|k| origin[k] / span[k]..(origin[k] + covered[k]).div_ceil(span[k]));
        y.flat_map(move |row| {
            x.clone().map(move |column| Tile {
                level: 0,
                face: tile.face,
                x: column as u16,
                y: row as u16,
            })
        })
    }

    /// All tiles of a level, in rank order.
    pub fn tiles_of(&self, level: u8) -> impl Iterator<Item = Tile> + '_ {
        (0..self.tiles_in_level(level)).map(move |rank| self.tile_at(level, rank))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::surface::Screen;

    fn grids() -> Vec<TileGrid> {
        let screen = Screen::default();
        [
            (Surface::cube(4096), Cut::Tile(256), 5, 2),
            (Surface::cube(3000), Cut::Grid([4, 4]), 3, 4),
            (
                Surface::cube(300).without_poles().for_two_eyes(),
                Cut::Tile(64),
                3,
                2,
            ),
            (
                Surface::flat([500, 300], screen).for_two_eyes(),
                Cut::Tile(64),
                3,
                2,
            ),
            (Surface::flat([1280, 720], screen), Cut::Tile(512), 5, 2),
            (
                Surface::equirect([1000, 500]).for_two_eyes(),
                Cut::Tile(64),
                4,
                2,
            ),
            (Surface::equirect([720, 361]), Cut::Grid([9, 5]), 3, 4),
            (Surface::flat([1281, 723], screen), Cut::Tile(128), 4, 2),
            (Surface::flat([7, 3], screen), Cut::Tile(128), 2, 2),
            (Surface::flat([1921, 801], screen), Cut::Grid([8, 4]), 3, 4),
            (Surface::flat([1, 20_000], screen), Cut::Tile(512), 5, 2),
        ]
        .map(|(surface, cut, levels, ratio)| TileGrid::new(surface, cut, levels, ratio).unwrap())
        .to_vec()
    }

    #[test]
    fn the_tiles_of_a_level_cover_every_pixel_once() {
        for grid in grids() {
            for level in 0..grid.levels {
                let covered: u64 = grid
                    .tiles_of(level)
                    .map(|tile| grid.covered(tile).map(u64::from).iter().product::<u64>())
                    .sum();
                assert_eq!(covered, grid.surface.pixels(), "{grid:?} level {level}");
            }
        }
    }

    #[test]
    fn a_rank_names_one_tile() {
        for grid in grids() {
            for level in 0..grid.levels {
                for (rank, tile) in grid.tiles_of(level).enumerate() {
                    assert_eq!(grid.rank(tile), rank as u32);
                }
            }
        }
    }

    #[test]
    fn the_tile_over_a_cell_covers_all_of_it() {
        for grid in grids() {
            for cell in grid.tiles_of(0) {
                for level in 0..grid.levels {
                    let over = grid.tile_over(cell, level);
                    let (from, span) = (grid.origin(over), grid.span(level));
                    let (cell_from, cell_span) = (grid.origin(cell), grid.covered(cell));
                    for k in 0..2 {
                        assert!(from[k] <= cell_from[k]);
                        assert!(cell_from[k] + cell_span[k] <= from[k] + span[k]);
                    }
                }
            }
        }
    }

    #[test]
    fn every_tile_has_one_twin_an_eye_in_the_same_direction() {
        for grid in grids() {
            for level in 0..grid.levels {
                let mut seen: Vec<Tile> = Vec::new();
                for left in grid.tiles_of_left_eye(level) {
                    for tile in grid.for_every_eye(left) {
                        assert_eq!(grid.for_left_eye(tile), left);
                        assert_eq!(grid.centre(tile), grid.centre(left));
                        seen.push(tile);
                    }
                }
                seen.sort_by_key(|tile| grid.rank(*tile));
                assert_eq!(seen, grid.tiles_of(level).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn kastner_s_grid_has_its_tile_sizes() {
        let grid = TileGrid::new(Surface::cube(3000), Cut::Grid([4, 4]), 3, 4).unwrap();
        let sides = [0, 1, 2].map(|level| grid.tile_size(grid.tile_at(level, 5))[0]);
        assert_eq!(sides, [750, 188, 47]);
    }

    #[test]
    fn a_coarsest_level_of_a_pyramid_is_one_tile_a_face() {
        let grid = TileGrid::new(Surface::cube(4096), Cut::Tile(256), 5, 2).unwrap();
        assert_eq!(grid.tiles_in_level(4), 6);
        assert_eq!(grid.tile_size(grid.tile_at(4, 3)), [256, 256]);
        let all: u32 = (0..5).map(|level| grid.tiles_in_level(level)).sum();
        assert_eq!(all, 1536 + 384 + 96 + 24 + 6);
    }

    #[test]
    fn sizes_out_of_range_are_refused() {
        let flat = |w, h| Surface::flat([w, h], Screen::default());
        for (surface, cut, levels, ratio) in [
            (flat(0, 5), Cut::Tile(64), 3, 2),
            (flat(1 << 17, 5), Cut::Tile(64), 3, 2),
            (flat(64, 64), Cut::Tile(63), 3, 2),
            (flat(64, 64), Cut::Tile(64), 0, 2),
            (flat(64, 64), Cut::Tile(64), 9, 2),
            (flat(64, 64), Cut::Tile(64), 3, 3),
            (flat(64, 64), Cut::Grid([64, 1]), 3, 2),
            (flat(64, 64), Cut::Grid([0, 1]), 3, 2),
            (flat(65_536, 65_536), Cut::Tile(16), 3, 2),
            (
                Surface {
                    eyes: 0,
                    ..flat(64, 64)
                },
                Cut::Tile(64),
                3,
                2,
            ),
            (
                Surface {
                    eyes: 3,
                    ..flat(64, 64)
                },
                Cut::Tile(64),
                3,
                2,
            ),
            (
                Surface {
                    cube_faces: 5,
                    ..Surface::cube(64)
                },
                Cut::Tile(64),
                3,
                2,
            ),
        ] {
            assert!(TileGrid::new(surface, cut, levels, ratio).is_err());
        }
    }
}
