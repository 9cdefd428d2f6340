//! Who decodes what is wanted at once, where nothing else goes on meanwhile?

use crate::supply::Supply;
use foveal_core::content::unit::AssetId;
use foveal_core::session::decoder::{Decoded, Decoder, PackBytes};
use foveal_core::session::unit_states::Piece;
use foveal_core::view::timeline::Timeline;
use std::time::Duration;

/// Frames of the coarsest level, which every moment needs, that may be decoded ahead.
const AHEAD: u64 = 2;

/// What is likely wanted next.
#[derive(Debug)]
pub(crate) struct Ahead {
    timeline: Timeline,
    /// The frame that was asked for last.
    frame: Option<u32>,
}

impl Ahead {
    pub(crate) fn of(bytes: &PackBytes) -> Self {
        Self {
            timeline: bytes.content().timeline(),
            frame: None,
        }
    }

    /// Has a decoder expect what the frames after `frame` need in any case, once it was asked for
    /// pieces of that.
    pub(crate) fn expect(&mut self, frame: u32, bytes: &PackBytes, decoder: &mut dyn Decoder) {
        if self.timeline.is_still() || self.frame.replace(frame) == Some(frame) {
            return;
        }
        let frames = self.timeline.frames();
        let next = (1..=AHEAD).map(|step| ((u64::from(frame) + step) % frames) as u32);
        let pieces = next.flat_map(|frame| {
            let base = bytes.content().base(frame).into_iter();
            base.map(move |unit| Piece {
                unit: AssetId::ONLY.unit(unit),
                frame,
            })
        });
        let pieces = pieces.map(|piece| (piece, bytes.of(piece.unit.unit)));
        decoder.expect(pieces.collect());
    }
}

/// Has a decoder do at once all that is wanted.
#[derive(Debug)]
pub(crate) struct AtOnce {
    bytes: PackBytes,
    decoder: Box<dyn Decoder>,
    ahead: Ahead,
}

impl AtOnce {
    /// Has `decoder` decode units of these bytes.
    pub(crate) fn new(bytes: PackBytes, decoder: Box<dyn Decoder>) -> Self {
        Self {
            ahead: Ahead::of(&bytes),
            bytes,
            decoder,
        }
    }
}

impl Supply for AtOnce {
    fn want(&mut self, pieces: &[Piece]) {
        self.decoder.cancel();
        let with_bytes = |piece: &Piece| (*piece, self.bytes.of(piece.unit.unit));
        let wanted = pieces.iter().map(with_bytes).collect();
        self.decoder.request(wanted);
        if let Some(piece) = pieces.first() {
            self.ahead
                .expect(piece.frame, &self.bytes, &mut *self.decoder);
        }
    }

    fn wait_for_all(&mut self, patience: Option<Duration>) {
        self.decoder.wait_for_all(patience);
    }

    fn next(&mut self, patience: Option<Duration>) -> Option<Decoded> {
        self.decoder.receive(patience)
    }
}
