//! Which decoder follows which tile?
//!
//! A tile's pictures build on each other, so every tile that is followed keeps a decoder of its
//! own. A decoder that was not used recently is given to the next tile of its size: opening
//! one is cheap, filling its memory for the first time is not.

use crate::tiles::decode::GroupDecoder;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::unit::UnitId;
use std::collections::HashMap;

/// Decoders that are kept open, at least.
const LEAST_KEPT: usize = 64;
/// Decoders that are kept open for each tile of a frame: those of the frame, and those that a gaze
/// comes back to.
const KEPT_PER_TILE: usize = 2;

/// A decoder that follows one tile.
pub(crate) struct Stream {
    pub(crate) decoder: GroupDecoder,
    /// The bytes of the group that it is in.
    pub(crate) chunk: Vec<u8>,
    /// Which group that is.
    pub(crate) unit: UnitId,
    /// The frame that comes out next.
    pub(crate) next: u32,
}

impl std::fmt::Debug for Stream {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (unit, next) = (self.unit.0, self.next);
        write!(out, "Stream {{ unit: {unit}, next: {next} }}")
    }
}

/// A decoder for a tile.
pub(crate) enum Held {
    /// The one that follows it.
    Stream(Stream),
    /// One of its size that followed another tile, and must be restarted.
    Spare(GroupDecoder),
    /// None: it is to be opened.
    Nothing,
}

/// The decoders that are not in use at the moment.
#[derive(Debug, Default)]
pub(crate) struct Streams {
    resting: HashMap<Tile, (u64, Stream)>,
    uses: u64,
    /// Tiles asked for of the frame before, and so far of this one.
    tiles_before: usize,
    tiles: usize,
    frame: Option<u32>,
}

impl Streams {
    /// Notes that a tile of a frame is asked for: as many decoders stay open as that takes.
    pub(crate) fn asked(&mut self, frame: u32) {
        if self.frame != Some(frame) {
            self.frame = Some(frame);
            self.tiles_before = self.tiles;
            self.tiles = 0;
        }
        self.tiles += 1;
    }

    /// The frame that comes out next of the decoder that follows a tile, if it is in this unit.
    pub(crate) fn next_of(&self, tile: Tile, unit: UnitId) -> Option<u32> {
        let (_, stream) = self.resting.get(&tile)?;
        (stream.unit == unit).then_some(stream.next)
    }

    /// A decoder for a tile, whose pictures have this size: the one that follows it, else the one
    /// that has rested longest, if there are more than stay open.
    pub(crate) fn take(&mut self, tile: Tile, size: [u32; 2]) -> Held {
        match self.resting.remove(&tile) {
            Some((_, stream)) => Held::Stream(stream),
            None => self.spare(size).map_or(Held::Nothing, Held::Spare),
        }
    }

    fn spare(&mut self, size: [u32; 2]) -> Option<GroupDecoder> {
        if self.resting.len() < self.most() {
            return None;
        }
        let of_size = |(_, (_, stream)): &(&Tile, &(u64, Stream))| stream.decoder.size() == size;
        let longest = self.resting.iter().filter(of_size);
        let tile = *longest.min_by_key(|(_, (used, _))| *used)?.0;
        self.resting.remove(&tile).map(|(_, it)| it.decoder)
    }

    /// Puts a decoder back; those that rested longest, beyond what stays open, are to be closed.
    pub(crate) fn put(&mut self, tile: Tile, stream: Stream) -> Vec<Stream> {
        self.uses += 1;
        self.resting.insert(tile, (self.uses, stream));
        let mut closed = Vec::new();
        while self.resting.len() > self.most() {
            let longest = self.resting.iter().min_by_key(|(_, (used, _))| *used);
            let tile = longest.map(|(tile, _)| *tile);
            let Some((_, stream)) = tile.and_then(|tile| self.resting.remove(&tile)) else {
                break;
            };
            closed.push(stream);
        }
        closed
    }

    fn most(&self) -> usize {
        LEAST_KEPT.max(KEPT_PER_TILE * self.tiles.max(self.tiles_before))
    }
}
