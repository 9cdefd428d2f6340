//! What does selection know of prepared content, beside how it is cut?

use crate::content::video::bytes::cue_table::CueTable;
use crate::content::video::bytes::pack::VideoPack;
use crate::content::video::bytes::signatures::Signatures;
use crate::content::video::grid::tile_grid::Tile;
use crate::pack::unit::UnitId;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::cues::Cues;

/// Sizes and measures of units. A unit shows a tile over a group of frames.
pub trait Content {
    /// The unit that shows a frame of a tile.
    fn unit(&self, tile: Tile, frame: u32) -> UnitId;
    /// The frame at which the next group of the finest level begins; `None` in the last.
    fn next_group(&self, frame: u32) -> Option<u32>;
    /// Bytes of a unit.
    fn bytes(&self, unit: UnitId) -> u32;
    /// What a unit adds to the next coarser level; `None` for the coarsest.
    fn signature(&self, unit: UnitId) -> Option<Signature>;
    /// What in it might draw the eye; `None` where that is not known.
    fn cues(&self, unit: UnitId) -> Option<Cues>;
}

/// A pack with the side tables that value its units.
#[derive(Clone, Copy, Debug)]
pub struct PackContent<'a> {
    /// Its description and index.
    pub pack: &'a VideoPack,
    /// What each unit adds.
    pub signatures: &'a Signatures,
    /// What might draw the eye, where that was noted.
    pub cues: Option<&'a CueTable>,
}

impl Content for PackContent<'_> {
    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        self.pack.unit(tile, frame)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        let about = self.pack.description();
        let length = about.groups.first()?;
        let next = (frame / length + 1) * length;
        (next < about.frames).then_some(next)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        self.pack.entry(unit).bytes
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        self.signatures.of(unit)
    }

    fn cues(&self, unit: UnitId) -> Option<Cues> {
        self.cues?.of(unit)
    }
}
