//! Where are the bytes of a unit?

use super::{
    ENTRY_BYTES, Header, MAX_CHUNK_BYTES, PAGE_ENTRIES, PAGE_HEAD_BYTES, PackError, check_crc,
    description::Description, u32_at, u64_at,
};
use crate::asset::tile_grid::{Tile, TileGrid};
use crate::asset::unit::UnitId;
use crate::units::counted;
use crate::view::surface::Screen;
use core::ops::Range;

/// Place and checksum of one chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Entry {
    /// First byte in the file.
    pub offset: u64,
    /// Length in bytes.
    pub bytes: u32,
    /// CRC32C of the chunk.
    pub crc32c: u32,
}

/// A pack's description and index: everything but the chunks and side tables.
///
/// The index may be there in part: pages come in any order, as a reader over a network asks for
/// them, and an entry is known once its page is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Pack {
    description: Description,
    layout: Layout,
    /// Where chunks lie.
    data: Range<u64>,
    index_offset: u64,
    /// Entries by page; as long as the last page that came.
    pages: Vec<Option<Box<[Entry]>>>,
}

/// How units are numbered: levels from the coarsest to the finest, in a level by group, then tile.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) grid: TileGrid,
    /// First unit of each level, by level.
    first: Vec<u32>,
    pub(super) units: u32,
    groups: Vec<u32>,
    frames: u32,
}

impl Layout {
    pub(super) fn new(description: &Description) -> Result<Self, PackError> {
        let grid = description.grid(Screen::default());
        let mut first = vec![0; usize::from(description.levels)];
        let mut units = 0u64;
        for level in (0..description.levels).rev() {
            let groups = description
                .frames
                .div_ceil(description.groups[usize::from(level)]);
            first[usize::from(level)] = units as u32;
            units += u64::from(groups) * u64::from(grid.tiles_in_level(level));
            if units > u64::from(u32::MAX) {
                return Err(PackError::new(
                    "units",
                    units,
                    "fewer than 2^32: use larger tiles",
                ));
            }
        }
        Ok(Self {
            grid,
            first,
            units: units as u32,
            groups: description.groups.clone(),
            frames: description.frames,
        })
    }

    pub(super) fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        assert!(frame < self.frames, "frame {frame} of {}", self.frames);
        let level = usize::from(tile.level);
        let group = frame / self.groups[level];
        let tiles = self.grid.tiles_in_level(tile.level);
        UnitId(self.first[level] + group * tiles + self.grid.rank(tile))
    }

    fn level_of(&self, unit: UnitId) -> u8 {
        assert!(unit.0 < self.units, "unit {} of {}", unit.0, self.units);
        // Levels are few and stored from the highest number down.
        let level = self.first.iter().position(|&first| first <= unit.0);
        level.unwrap_or_default() as u8
    }

    /// The first unit after a level's.
    fn end(&self, level: usize) -> u32 {
        level
            .checked_sub(1)
            .map_or(self.units, |finer| self.first[finer])
    }

    /// Pages, and bytes of the index, before those of a level.
    fn before(&self, level: usize) -> (u32, u64) {
        let coarser = level + 1..self.first.len();
        coarser.fold((0, 0), |(pages, bytes), level| {
            let entries = self.end(level) - self.first[level];
            let of_level = entries.div_ceil(PAGE_ENTRIES as u32);
            (pages + of_level, bytes + bytes_of(entries))
        })
    }

    /// The page that holds a unit's entry.
    fn page_of(&self, unit: UnitId) -> u32 {
        let level = usize::from(self.level_of(unit));
        self.before(level).0 + (unit.0 - self.first[level]) / PAGE_ENTRIES as u32
    }

    /// The units of a page, and where its bytes are in the index; `None` beyond the last.
    fn page(&self, page: u32) -> Option<(Range<u32>, Range<u64>)> {
        let levels = 0..self.first.len();
        // Levels follow each other from the coarsest, which has the highest number.
        let level = levels.rev().rfind(|&level| self.before(level).0 <= page)?;
        let (pages, bytes) = self.before(level);
        let within = u64::from(page - pages) * PAGE_ENTRIES as u64;
        let from = u64::from(self.first[level]) + within;
        let end = u64::from(self.end(level));
        if from >= end {
            return None;
        }
        let units = from as u32..end.min(from + PAGE_ENTRIES as u64) as u32;
        let begin = bytes + u64::from(page - pages) * bytes_of(PAGE_ENTRIES as u32);
        let end = begin + bytes_of(units.len() as u32);
        Some((units, begin..end))
    }

    /// Units of each page of the index, in file order.
    pub(super) fn pages(&self) -> Vec<Range<u32>> {
        let mut pages = Vec::new();
        for level in (0..self.first.len()).rev() {
            let end = self.end(level);
            let mut from = self.first[level];
            while from < end {
                let to = end.min(from + PAGE_ENTRIES as u32);
                pages.push(from..to);
                from = to;
            }
        }
        pages
    }

    pub(super) fn index_bytes(&self) -> u64 {
        // Every level begins a page, so count whole levels instead of building the page list of
        // bytes that are not checked yet.
        (0..self.first.len())
            .map(|level| bytes_of(self.end(level) - self.first[level]))
            .sum()
    }
}

/// Bytes of the index that a level's entries take.
fn bytes_of(entries: u32) -> u64 {
    let pages = entries.div_ceil(PAGE_ENTRIES as u32);
    u64::from(entries) * ENTRY_BYTES as u64 + u64::from(pages) * PAGE_HEAD_BYTES as u64
}

impl Pack {
    /// Reads the description and the whole index of a pack whose header is `header`.
    ///
    /// Refuses bytes with a wrong checksum, entries outside the chunks' part of the file and
    /// lengths beyond [`MAX_CHUNK_BYTES`]. Allocates no more than the index is long.
    pub fn parse(header: &Header, description: &[u8], index: &[u8]) -> Result<Self, PackError> {
        let mut pack = Self::begin(header, description)?;
        if index.len() as u64 != header.index_bytes {
            let found = counted(index.len(), "byte");
            return Err(pack.wrong_index(found));
        }
        let mut at = 0;
        for (number, units) in pack.layout.pages().into_iter().enumerate() {
            let bytes = bytes_of(units.len() as u32) as usize;
            pack.add_page(number as u32, &index[at..at + bytes])?;
            at += bytes;
        }
        Ok(pack)
    }

    /// Reads the description of a pack whose header is `header`; no page of the index is there
    /// yet.
    pub fn begin(header: &Header, description: &[u8]) -> Result<Self, PackError> {
        check_crc("description", description, header.description_crc)?;
        let description = Description::parse(description)?;
        let pack = Self {
            layout: Layout::new(&description)?,
            description,
            data: header.data_offset()..header.index_offset,
            index_offset: header.index_offset,
            pages: Vec::new(),
        };
        if header.index_bytes != pack.layout.index_bytes() {
            return Err(pack.wrong_index(counted(header.index_bytes, "byte")));
        }
        Ok(pack)
    }

    fn wrong_index(&self, found: String) -> PackError {
        PackError::new("index", found, counted(self.layout.index_bytes(), "byte"))
    }

    /// Takes the bytes of an index page, wherever among the others it comes. Refuses a wrong
    /// checksum, another page, and entries outside the chunks' part of the file or longer than
    /// [`MAX_CHUNK_BYTES`].
    pub fn add_page(&mut self, page: u32, bytes: &[u8]) -> Result<(), PackError> {
        let field = format!("index page {page}");
        let wrong = |found: String, expected: &str| PackError::new(&field, found, expected);
        let Some((units, place)) = self.layout.page(page) else {
            return Err(wrong("a number beyond the last".to_owned(), "a page of it"));
        };
        if bytes.len() as u64 != place.end - place.start {
            let expected = counted(place.end - place.start, "byte");
            return Err(wrong(counted(bytes.len(), "byte"), &expected));
        }
        let entries = parse_page(page, units.clone(), bytes)?;
        for (unit, entry) in units.zip(entries.iter()) {
            self.check_entry(unit, entry)?;
        }
        let at = page as usize;
        self.pages.resize(self.pages.len().max(at + 1), None);
        self.pages[at] = Some(entries);
        Ok(())
    }

    fn check_entry(&self, unit: u32, entry: &Entry) -> Result<(), PackError> {
        let end = entry.offset.checked_add(u64::from(entry.bytes));
        let inside = entry.offset >= self.data.start && end.is_some_and(|end| end <= self.data.end);
        if inside && entry.bytes <= MAX_CHUNK_BYTES {
            return Ok(());
        }
        let found = format!("{}+{}", entry.offset, entry.bytes);
        let expected = format!("within {:?}, at most {MAX_CHUNK_BYTES} bytes", self.data);
        Err(PackError::new(
            &format!("entry of unit {unit}"),
            found,
            expected,
        ))
    }

    /// The index page that tells of a unit.
    #[must_use]
    pub fn page_of(&self, unit: UnitId) -> u32 {
        self.layout.page_of(unit)
    }

    /// Where in the file a page of the index lies; `None` beyond the last.
    #[must_use]
    pub fn page_place(&self, page: u32) -> Option<Range<u64>> {
        let (_, place) = self.layout.page(page)?;
        Some(self.index_offset + place.start..self.index_offset + place.end)
    }

    /// Whether a page of the index is there.
    #[must_use]
    pub fn has_page(&self, page: u32) -> bool {
        self.pages.get(page as usize).is_some_and(Option::is_some)
    }

    /// Bytes of the index that a pack of this description has: to be compared with the header
    /// before that many bytes are read.
    pub fn expected_index_bytes(description: &[u8]) -> Result<u64, PackError> {
        Ok(Layout::new(&Description::parse(description)?)?.index_bytes())
    }

    /// What the pack says about its content.
    #[must_use]
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The tile grid, with flat content filling the default screen.
    #[must_use]
    pub fn grid(&self) -> &TileGrid {
        &self.layout.grid
    }

    /// All units, coarsest level first.
    pub fn units(&self) -> impl ExactSizeIterator<Item = UnitId> + use<> {
        (0..self.layout.units as usize).map(|unit| UnitId(unit as u32))
    }

    /// The first unit that is finer than the coarsest level; where there is only one level, the
    /// number of units.
    #[must_use]
    pub fn first_refining_unit(&self) -> UnitId {
        let finer = usize::from(self.description.levels).checked_sub(2);
        UnitId(finer.map_or(self.layout.units, |level| self.layout.first[level]))
    }

    /// The unit that holds `frame` of `tile`. O(1). The frame must exist.
    #[must_use]
    pub fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        self.layout.unit(tile, frame)
    }

    /// Place and checksum of a unit's chunk. O(1).
    ///
    /// # Panics
    /// Its page of the index must be there.
    #[must_use]
    pub fn entry(&self, unit: UnitId) -> Entry {
        let entry = self.known_entry(unit);
        assert!(entry.is_some(), "the page of unit {} is not there", unit.0);
        entry.unwrap_or_default()
    }

    /// Place and checksum of a unit's chunk, where its page of the index is there. O(1).
    #[must_use]
    pub fn known_entry(&self, unit: UnitId) -> Option<Entry> {
        let level = usize::from(self.layout.level_of(unit));
        let within = (unit.0 - self.layout.first[level]) as usize % PAGE_ENTRIES;
        let page = self.pages.get(self.page_of(unit) as usize)?.as_ref()?;
        page.get(within).copied()
    }

    /// The tile of a unit.
    #[must_use]
    pub fn tile_of(&self, unit: UnitId) -> Tile {
        let level = self.layout.level_of(unit);
        let tiles = self.layout.grid.tiles_in_level(level);
        let within = unit.0 - self.layout.first[usize::from(level)];
        self.layout.grid.tile_at(level, within % tiles)
    }

    /// The frames that a unit holds.
    #[must_use]
    pub fn frames_of(&self, unit: UnitId) -> Range<u32> {
        let level = self.layout.level_of(unit);
        let tiles = self.layout.grid.tiles_in_level(level);
        let group = (unit.0 - self.layout.first[usize::from(level)]) / tiles;
        let length = self.layout.groups[usize::from(level)];
        group * length..((group + 1) * length).min(self.layout.frames)
    }

    /// Bytes of all chunks of each level, finest first.
    #[must_use]
    pub fn bytes_per_level(&self) -> Vec<u64> {
        let mut bytes = vec![0; usize::from(self.description.levels)];
        for unit in self.units() {
            let level = self.layout.level_of(unit);
            bytes[usize::from(level)] += u64::from(self.entry(unit).bytes);
        }
        bytes
    }

    /// Whether chunks and side tables fill the file without gap or overlap, so that every byte is
    /// under some checksum.
    pub fn check_coverage(&self, header: &Header) -> Result<(), PackError> {
        let chunks = self
            .units()
            .map(|unit| self.entry(unit))
            .map(|e| (e.offset, u64::from(e.bytes)))
            .collect();
        check_filled("chunks", chunks, header.data_offset()..header.index_offset)?;
        let tables = self
            .description
            .tables
            .iter()
            .map(|t| (t.offset, t.bytes))
            .collect();
        let after_index = header.index_offset + header.index_bytes;
        check_filled("side tables", tables, after_index..header.file_bytes)
    }
}

fn check_filled(
    what: &str,
    mut parts: Vec<(u64, u64)>,
    place: Range<u64>,
) -> Result<(), PackError> {
    parts.sort_unstable();
    let mut at = place.start;
    for (offset, bytes) in parts {
        let end = offset.checked_add(bytes).filter(|&end| end <= place.end);
        match end {
            Some(end) if offset == at => at = end,
            _ => return Err(PackError::new(what, format!("one at {offset}+{bytes}"), at)),
        }
    }
    if at == place.end {
        Ok(())
    } else {
        Err(PackError::new(what, format!("end at {at}"), place.end))
    }
}

fn parse_page(page: u32, units: Range<u32>, bytes: &[u8]) -> Result<Box<[Entry]>, PackError> {
    let field = format!("index page {page}");
    // The checksum covers the page with its own field left out.
    let (head, rows) = bytes.split_at(PAGE_HEAD_BYTES);
    let found = crc32c::crc32c_append(crc32c::crc32c(&head[..12]), rows);
    if found != u32_at(head, 12) {
        return Err(PackError::checksum(&field, found, u32_at(head, 12)));
    }
    let told = [u32_at(head, 0), u32_at(head, 4), u32_at(head, 8)];
    let expected = [page, units.start, units.len() as u32];
    if told != expected {
        return Err(PackError::new(
            &field,
            format!("{told:?}"),
            format!("{expected:?}"),
        ));
    }
    let entry = |entry: &[u8]| Entry {
        offset: u64_at(entry, 0),
        bytes: u32_at(entry, 8),
        crc32c: u32_at(entry, 12),
    };
    Ok(rows.chunks_exact(ENTRY_BYTES).map(entry).collect())
}

/// The access units of a chunk that holds `frames` frames: a table of lengths, then the bytes.
pub fn split_chunk(chunk: &[u8], frames: usize) -> Result<Vec<&[u8]>, PackError> {
    let wrong = |found: String| PackError::new("chunk", found, counted(frames, "access unit"));
    let table = frames * 4;
    if chunk.len() < table {
        return Err(wrong(counted(chunk.len(), "byte")));
    }
    let mut rest = &chunk[table..];
    let mut units = Vec::with_capacity(frames);
    for frame in 0..frames {
        let bytes = u32_at(chunk, frame * 4) as usize;
        if bytes > rest.len() {
            return Err(wrong(format!(
                "{} for number {frame}, {} left",
                counted(bytes, "byte"),
                rest.len()
            )));
        }
        let (unit, after) = rest.split_at(bytes);
        units.push(unit);
        rest = after;
    }
    if rest.is_empty() {
        Ok(units)
    } else {
        Err(wrong(counted(rest.len(), "further byte")))
    }
}
