//! Which unit of a pack holds a frame of a tile, and where are its bytes?

use super::chunk::split_chunk;
use super::description::Description;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::pack::unit::UnitId;
use crate::pack::{Entry, HEADER_BYTES, Header, Index, PackError, UnitNumbers, check_crc};
use crate::view::surface::Screen;
use core::ops::Range;

/// Description and index of a pack of video: everything but the chunks and side tables.
///
/// Units are numbered in a level by group of frames, then by tile.
#[derive(Clone, Debug, PartialEq)]
pub struct VideoPack {
    description: Description,
    grid: TileGrid,
    index: Index,
}

/// How many units the levels of a pack of this description have.
pub(super) fn numbers_of(description: &Description) -> Result<UnitNumbers, PackError> {
    let grid = description.grid(Screen::default());
    let units = (0..description.levels).map(|level| {
        let length = description.groups[usize::from(level)];
        let groups = description.frames.div_ceil(length);
        u64::from(groups) * u64::from(grid.tiles_in_level(level))
    });
    UnitNumbers::new(&units.collect::<Vec<_>>())
}

/// The unit that holds `frame` of `tile` by this numbers of a pack of this description.
pub(super) fn unit_of(
    numbers: &UnitNumbers,
    (description, grid): (&Description, &TileGrid),
    tile: Tile,
    frame: u32,
) -> UnitId {
    let frames = description.frames;
    assert!(frame < frames, "frame {frame} of {frames}");
    let group = frame / description.groups[usize::from(tile.level)];
    let tiles = grid.tiles_in_level(tile.level);
    UnitId(numbers.first_of(tile.level).0 + group * tiles + grid.rank(tile))
}

impl VideoPack {
    /// Reads the description and the whole index of a pack whose header is `header`.
    ///
    /// Refuses bytes with a wrong checksum, entries outside the chunks' part of the file and
    /// lengths beyond [`MAX_CHUNK_BYTES`](crate::pack::MAX_CHUNK_BYTES). Allocates no more than
    /// the index is long.
    pub fn parse(header: &Header, description: &[u8], index: &[u8]) -> Result<Self, PackError> {
        let pack = Self::begin(header, description)?;
        pack.index.add_all(index)?;
        Ok(pack)
    }

    /// Reads the description of a pack whose header is `header`; no page of the index is loaded
    /// yet.
    pub fn begin(header: &Header, description: &[u8]) -> Result<Self, PackError> {
        check_crc("description", description, header.description_crc)?;
        let description = Description::parse(description)?;
        Ok(Self {
            index: Index::new(header, numbers_of(&description)?)?,
            grid: description.grid(Screen::default()),
            description,
        })
    }

    /// What the pack says about its content.
    #[must_use]
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The tile grid, with flat content filling the default screen.
    #[must_use]
    pub fn grid(&self) -> &TileGrid {
        &self.grid
    }

    /// Where the chunks of units lie.
    #[must_use]
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// All units, coarsest level first.
    pub fn units(&self) -> impl ExactSizeIterator<Item = UnitId> + use<> {
        self.index.units()
    }

    /// The first unit that is finer than the coarsest level; where there is only one level, the
    /// number of units.
    #[must_use]
    pub fn first_refining_unit(&self) -> UnitId {
        let numbers = self.index.numbers();
        let finer = self.description.levels.checked_sub(2);
        finer.map_or(UnitId(numbers.units()), |level| numbers.first_of(level))
    }

    /// The unit that holds `frame` of `tile`. O(1). The frame must exist.
    #[must_use]
    pub fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        let about = (&self.description, &self.grid);
        unit_of(self.index.numbers(), about, tile, frame)
    }

    /// Place and checksum of a unit's chunk. O(1).
    ///
    /// # Panics
    /// Its page of the index must have been loaded.
    #[must_use]
    pub fn entry(&self, unit: UnitId) -> Entry {
        self.index.entry(unit)
    }

    /// The tile of a unit.
    #[must_use]
    pub fn tile_of(&self, unit: UnitId) -> Tile {
        let (level, within) = self.within_level(unit);
        let tiles = self.grid.tiles_in_level(level);
        self.grid.tile_at(level, within % tiles)
    }

    /// What errors call the chunk of a unit.
    #[must_use]
    pub fn chunk_name(&self, unit: UnitId) -> String {
        let (tile, frames) = (self.tile_of(unit), self.frames_of(unit));
        format!(
            "chunk of level {}, face {}, column {}, row {}, frames {}-{}",
            tile.level,
            tile.face,
            tile.x,
            tile.y,
            frames.start,
            frames.end - 1
        )
    }

    /// The frames that a unit holds.
    #[must_use]
    pub fn frames_of(&self, unit: UnitId) -> Range<u32> {
        let (level, within) = self.within_level(unit);
        let group = within / self.grid.tiles_in_level(level);
        let length = self.description.groups[usize::from(level)];
        group * length..((group + 1) * length).min(self.description.frames)
    }

    /// The level of a unit, and its number within the level.
    fn within_level(&self, unit: UnitId) -> (u8, u32) {
        let numbers = self.index.numbers();
        let level = numbers.level_of(unit);
        (level, unit.0 - numbers.first_of(level).0)
    }

    /// Whether chunks and side tables fill the file without gap or overlap, so that every byte is
    /// under some checksum.
    pub fn check_coverage(&self, header: &Header) -> Result<(), PackError> {
        self.index.check_coverage(header, &self.description.tables)
    }
}

/// Takes any bytes for a whole pack and reads all of it that can be read: the body of the fuzz
/// target. Returns whether they were a pack.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    let Ok(header) = Header::parse(data) else {
        return false;
    };
    if header.file_bytes != data.len() as u64 {
        return false;
    }
    let part = |from: u64, bytes: u64| {
        let from = usize::try_from(from).ok()?;
        data.get(from..from.checked_add(usize::try_from(bytes).ok()?)?)
    };
    let description = part(HEADER_BYTES as u64, u64::from(header.description_bytes));
    let index = part(header.index_offset, header.index_bytes);
    let (Some(description), Some(index)) = (description, index) else {
        return false;
    };
    let Ok(pack) = VideoPack::parse(&header, description, index) else {
        return false;
    };
    for unit in pack.units() {
        let entry = pack.entry(unit);
        if let Some(chunk) = part(entry.offset, u64::from(entry.bytes)) {
            let _ = split_chunk(chunk, pack.frames_of(unit).len());
        }
    }
    pack.check_coverage(&header).is_ok()
}
