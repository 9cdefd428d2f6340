//! What do choices know of prepared video, besides how it is cut?

use crate::content::video::calibration::Scale;
use crate::content::video::grid::places::SharedPlaces;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::pack::unit::UnitId;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::cues::Cues;
use crate::view::eye_view::EyeView;

/// Numbers, sizes and measures of the units of a video. A unit shows a tile over a group of frames.
pub trait VideoUnits: core::fmt::Debug + Send + Sync {
    /// The unit that shows a frame of a tile.
    fn unit(&self, tile: Tile, frame: u32) -> UnitId;
    /// The frame at which the next group of the finest level begins; `None` in the last.
    fn next_group(&self, frame: u32) -> Option<u32>;
    /// Bytes of a unit; the largest number where they are not known yet.
    fn bytes(&self, unit: UnitId) -> u32;
    /// Whether it is known what units add.
    fn has_signatures(&self) -> bool;
    /// What a unit adds to the next coarser level; `None` for the coarsest.
    fn signature(&self, unit: UnitId) -> Option<Signature>;
    /// Whether signatures include the noise of coding, which a view that shows content smaller than
    /// it is does not average away.
    fn tells_of_noise(&self) -> bool {
        false
    }
    /// What in it might draw the eye; `None` where that is not known.
    fn cues(&self, unit: UnitId) -> Option<Cues>;
    /// The places of the cells of `grid` for all who choose from it; `None` where each makes them.
    fn places(&self, grid: &TileGrid) -> Option<&SharedPlaces> {
        let _ = grid;
        None
    }
    /// From what signatures predict for it to the judge's scores, in this view.
    fn scale(&self, view: Option<&EyeView>) -> Scale {
        let _ = view;
        Scale::usual()
    }
}

/// The units of a video of which no more is known than how it is cut.
#[derive(Clone, Copy, Debug)]
pub struct UnknownUnits(TileGrid);

impl UnknownUnits {
    /// Units of this grid.
    #[must_use]
    pub fn new(grid: TileGrid) -> Self {
        Self(grid)
    }
}

impl VideoUnits for UnknownUnits {
    fn unit(&self, tile: Tile, _: u32) -> UnitId {
        let coarser = tile.level + 1..self.0.levels;
        let before: u32 = coarser.map(|level| self.0.tiles_in_level(level)).sum();
        UnitId(before + self.0.rank(tile))
    }

    fn next_group(&self, _: u32) -> Option<u32> {
        None
    }

    fn bytes(&self, _: UnitId) -> u32 {
        u32::MAX
    }

    fn has_signatures(&self) -> bool {
        false
    }

    fn signature(&self, _: UnitId) -> Option<Signature> {
        None
    }

    fn cues(&self, _: UnitId) -> Option<Cues> {
        None
    }
}
