//! Where are the bytes of a unit?

use super::{
    ENTRY_BYTES, Header, MAX_CHUNK_BYTES, PAGE_ENTRIES, PAGE_HEAD_BYTES, PackError, check_crc,
    description::Description, u32_at, u64_at,
};
use crate::asset::tile_grid::{Tile, TileGrid};
use crate::asset::unit::UnitId;
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
#[derive(Clone, Debug, PartialEq)]
pub struct Pack {
    description: Description,
    layout: Layout,
    entries: Vec<Entry>,
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

    /// Units of each page of the index, in file order.
    pub(super) fn pages(&self) -> Vec<Range<u32>> {
        let mut pages = Vec::new();
        for level in (0..self.first.len()).rev() {
            let end = if level == 0 {
                self.units
            } else {
                self.first[level - 1]
            };
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
            .map(|level| {
                let end = if level == 0 {
                    self.units
                } else {
                    self.first[level - 1]
                };
                let entries = u64::from(end - self.first[level]);
                entries * ENTRY_BYTES as u64
                    + entries.div_ceil(PAGE_ENTRIES as u64) * PAGE_HEAD_BYTES as u64
            })
            .sum()
    }
}

impl Pack {
    /// Reads the description and the whole index of a pack whose header is `header`.
    ///
    /// Refuses bytes with a wrong checksum, entries outside the chunks' part of the file and
    /// lengths beyond [`MAX_CHUNK_BYTES`]. Allocates no more than the index is long.
    pub fn parse(header: &Header, description: &[u8], index: &[u8]) -> Result<Self, PackError> {
        check_crc("description", description, header.description_crc)?;
        let description = Description::parse(description)?;
        let layout = Layout::new(&description)?;
        if index.len() as u64 != layout.index_bytes() || header.index_bytes != layout.index_bytes()
        {
            let found = format!("{} bytes", index.len());
            return Err(PackError::new(
                "index",
                found,
                format!("{} bytes", layout.index_bytes()),
            ));
        }
        let mut entries = Vec::with_capacity(layout.units as usize);
        let mut at = 0;
        for (number, units) in layout.pages().into_iter().enumerate() {
            let bytes = PAGE_HEAD_BYTES + units.len() * ENTRY_BYTES;
            parse_page(number, units, &index[at..at + bytes], &mut entries)?;
            at += bytes;
        }
        let data = header.data_offset()..header.index_offset;
        for (unit, entry) in entries.iter().enumerate() {
            let end = entry.offset.checked_add(u64::from(entry.bytes));
            let inside = entry.offset >= data.start && end.is_some_and(|end| end <= data.end);
            if !inside || entry.bytes > MAX_CHUNK_BYTES {
                let found = format!("{}+{}", entry.offset, entry.bytes);
                let expected = format!("within {data:?}, at most {MAX_CHUNK_BYTES} bytes");
                return Err(PackError::new(
                    &format!("entry of unit {unit}"),
                    found,
                    expected,
                ));
            }
        }
        Ok(Self {
            description,
            layout,
            entries,
        })
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
    #[must_use]
    pub fn entry(&self, unit: UnitId) -> Entry {
        self.entries[unit.0 as usize]
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
            .entries
            .iter()
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

fn parse_page(
    number: usize,
    units: Range<u32>,
    bytes: &[u8],
    entries: &mut Vec<Entry>,
) -> Result<(), PackError> {
    let field = format!("index page {number}");
    let mut covered = [bytes, &[]];
    // The checksum covers the page with its own field left out.
    covered[0] = &bytes[..12];
    covered[1] = &bytes[PAGE_HEAD_BYTES..];
    let found = crc32c::crc32c_append(crc32c::crc32c(covered[0]), covered[1]);
    if found != u32_at(bytes, 12) {
        return Err(PackError::checksum(&field, found, u32_at(bytes, 12)));
    }
    let head = [u32_at(bytes, 0), u32_at(bytes, 4), u32_at(bytes, 8)];
    let expected = [number as u32, units.start, units.len() as u32];
    if head != expected {
        return Err(PackError::new(
            &field,
            format!("{head:?}"),
            format!("{expected:?}"),
        ));
    }
    entries.extend(
        bytes[PAGE_HEAD_BYTES..]
            .chunks_exact(ENTRY_BYTES)
            .map(|entry| Entry {
                offset: u64_at(entry, 0),
                bytes: u32_at(entry, 8),
                crc32c: u32_at(entry, 12),
            }),
    );
    Ok(())
}

/// The access units of a chunk that holds `frames` frames: a table of lengths, then the bytes.
pub fn split_chunk(chunk: &[u8], frames: usize) -> Result<Vec<&[u8]>, PackError> {
    let wrong = |found: String| PackError::new("chunk", found, format!("{frames} access units"));
    let table = frames * 4;
    if chunk.len() < table {
        return Err(wrong(format!("{} bytes", chunk.len())));
    }
    let mut rest = &chunk[table..];
    let mut units = Vec::with_capacity(frames);
    for frame in 0..frames {
        let bytes = u32_at(chunk, frame * 4) as usize;
        if bytes > rest.len() {
            return Err(wrong(format!(
                "{bytes} bytes for number {frame}, {} left",
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
        Err(wrong(format!("{} bytes more", rest.len())))
    }
}
