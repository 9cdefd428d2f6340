//! What do a page and its player tell each other about stretches of the file?

use foveal_core::pack::unit::UnitId;
use serde::Serialize;
use std::collections::HashMap;
use std::ops::Range;

/// A stretch of the file that is needed: the `Need` of `web/src/engine/needs.ts`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Need {
    /// First byte.
    pub offset: u64,
    /// Length in bytes.
    pub bytes: u64,
    /// Nothing waits for it yet.
    pub early: bool,
    /// Of a tile: the picture to decode of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<PictureNeed>,
    /// The unit of a tile that may be shown soon: its bytes wait in memory.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ahead: Option<UnitId>,
    /// What it holds.
    #[serde(skip)]
    pub part: Part,
}

/// A frame of a tile, of which a browser's decoder makes a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PictureNeed {
    /// The tile over its frames.
    pub unit: UnitId,
    /// The frame of it.
    pub frame: u32,
    /// The unit's first frame.
    pub first: u32,
    /// How many frames it has.
    pub frames: u32,
    /// Columns of the tile.
    pub width: u32,
    /// Rows of the tile.
    pub height: u32,
}

/// What a stretch of the file holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// What must be there before the pack is open.
    Beginning,
    /// A page of the index.
    Page(u32),
    /// The side table of this name.
    Table(String),
    /// The chunk of a unit.
    Unit(UnitId),
}

impl Need {
    /// What is waited for.
    pub(crate) fn of(part: Part, place: Range<u64>) -> Self {
        Self {
            offset: place.start,
            bytes: place.end - place.start,
            early: false,
            picture: None,
            ahead: None,
            part,
        }
    }
}

/// What there is to do for a stretch that came: the `Arrival` of `web/src/engine/needs.ts`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub enum Arrival {
    /// Nothing: it was taken, or cannot be had.
    Taken,
    /// It was taken, and says what is needed next.
    More,
    /// The browser decodes it: where its access units begin, and where the last one ends.
    Decode(Vec<u32>),
    /// It is damaged, for the first time: fetch it again.
    Again,
}

/// What a player asked for, and what of it was damaged.
#[derive(Debug, Default)]
pub(crate) struct Fetching {
    /// What was asked for last.
    pub(crate) needs: Vec<Need>,
    /// Whether sound is asked for.
    pub(crate) hears: bool,
    /// How often each stretch was damaged, by its first byte.
    pub(crate) damaged: HashMap<u64, u32>,
}
