//! Who reads the bytes of units, and who makes of them what is drawn?
//!
//! Core does neither. A player hands what a session wants to a [`Decoder`], each piece with the
//! [`UnitBytes`] that hold it; they come from a [`ByteSource`] once the decoder reads them.

use crate::content::demand::Content;
use crate::content::payload::Payload;
use crate::pack::PackError;
use crate::pack::unit::UnitId;
use crate::session::unit_states::Piece;
use core::error::Error;
use core::fmt::{Debug, Display, Formatter};
use core::ops::Range;
use core::time::Duration;
use std::collections::VecDeque;
use std::sync::Arc;

/// Answers ranges of a pack's bytes, wherever these are.
pub trait ByteSource: Debug + Send + Sync {
    /// The bytes of a range; errors call them by what `what` says. May block.
    ///
    /// # Errors
    /// They cannot be had.
    fn read(&self, range: Range<u64>, what: &dyn Fn() -> String) -> Result<Vec<u8>, SourceError>;

    /// Bytes of it that are damaged, as an error that names the pack.
    fn damaged(&self, error: PackError) -> SourceError;
}

/// Why bytes of a pack cannot be had, naming the pack.
#[derive(Debug)]
pub struct SourceError(pub Box<dyn Error + Send + Sync>);

impl Display for SourceError {
    fn fmt(&self, out: &mut Formatter<'_>) -> core::fmt::Result {
        Display::fmt(&self.0, out)
    }
}

impl Error for SourceError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.0.source()
    }
}

/// The units of a pack, and the source of their bytes.
#[derive(Clone, Debug)]
pub struct PackBytes {
    content: Arc<dyn Content>,
    source: Arc<dyn ByteSource>,
}

impl PackBytes {
    /// The units of `content`, whose pack `source` reads.
    #[must_use]
    pub fn new(content: Arc<dyn Content>, source: Arc<dyn ByteSource>) -> Self {
        Self { content, source }
    }

    /// The bytes of a unit; nothing is read yet.
    #[must_use]
    pub fn of(&self, unit: UnitId) -> UnitBytes {
        UnitBytes {
            pack: self.clone(),
            unit,
        }
    }

    /// What is chosen from.
    #[must_use]
    pub fn content(&self) -> &Arc<dyn Content> {
        &self.content
    }
}

/// The bytes of a unit, not read yet.
#[derive(Clone, Debug)]
pub struct UnitBytes {
    pack: PackBytes,
    unit: UnitId,
}

impl UnitBytes {
    /// What is drawn of the unit, where its bytes say so without a codec.
    fn parse(&self) -> Result<Payload, SourceError> {
        let PackBytes { content, source } = &self.pack;
        let payload = content.payload(self.unit, &self.read()?);
        payload.map_err(|error| source.damaged(error))
    }

    /// The bytes, their checksum checked. May block.
    ///
    /// # Errors
    /// They cannot be had, or are damaged.
    pub fn read(&self) -> Result<Vec<u8>, SourceError> {
        let PackBytes { content, source } = &self.pack;
        let what = || content.chunk_name(self.unit);
        let place = content.place(self.unit).known(&what());
        let place = place.map_err(|error| source.damaged(error))?;
        let bytes = source.read(place.range(), &what)?;
        let checked = place.check(&what(), &bytes);
        checked.map_err(|error| source.damaged(error))?;
        Ok(bytes)
    }
}

/// Makes of pieces what is drawn. It is handed bytes, and reads no file.
pub trait Decoder: Debug + Send {
    /// Asks for pieces, after all that was asked for before.
    fn request(&mut self, pieces: Vec<(Piece, UnitBytes)>);

    /// Pieces that are likely asked for next and may be decoded meanwhile, in the place of those
    /// that were expected before.
    fn expect(&mut self, pieces: Vec<(Piece, UnitBytes)>) {
        let _ = pieces;
    }

    /// The next piece that is done, in any order; waits for it at most this long, or without
    /// limit. `None` where nothing is under way, or nothing was done in time.
    fn receive(&mut self, patience: Option<Duration>) -> Option<Decoded>;

    /// Waits until all that was asked for is done, at most this long, or without limit; what is
    /// done is then received without waiting.
    fn wait_for_all(&mut self, patience: Option<Duration>) {
        let _ = patience;
    }

    /// Takes back what was not begun.
    fn cancel(&mut self);
}

/// A piece that a decoder is done with.
#[derive(Debug)]
pub struct Decoded {
    /// What was asked for.
    pub piece: Piece,
    /// Frames decoded for it, those to catch up included.
    pub frames: u32,
    /// What is drawn.
    pub payload: Result<Payload, DecodeError>,
}

/// Why a piece has no payload.
#[derive(Debug)]
pub enum DecodeError {
    /// It is damaged: coarser pieces stand in for it.
    Damaged(Box<dyn Error + Send + Sync>),
    /// The decoder made something else than what it was asked for.
    Wrong(Box<dyn Error + Send + Sync>),
}

/// Decodes what needs no codec, one piece after the other: that takes less time than what is done
/// with it.
#[derive(Debug, Default)]
pub struct Parser {
    asked: VecDeque<(Piece, UnitBytes)>,
}

impl Decoder for Parser {
    fn request(&mut self, pieces: Vec<(Piece, UnitBytes)>) {
        self.asked.extend(pieces);
    }

    fn receive(&mut self, _patience: Option<Duration>) -> Option<Decoded> {
        let (piece, bytes) = self.asked.pop_front()?;
        let payload = bytes.parse();
        Some(Decoded {
            piece,
            frames: 1,
            payload: payload.map_err(|error| DecodeError::Damaged(error.0)),
        })
    }

    fn cancel(&mut self) {
        self.asked.clear();
    }
}
