//! Where are the bytes of a unit?

use super::error::{PackError, check_crc, check_crc_of, u32_at, u64_at};
use super::header::Header;
use super::tables::TableEntry;
use super::unit::UnitId;
use crate::units::counted;
use core::ops::Range;
use std::sync::OnceLock;

/// Index entries in a full page, unless the description says otherwise.
pub(super) const PAGE_ENTRIES: u32 = 1024;
/// Bytes of one index entry.
const ENTRY_BYTES: usize = 16;
/// Bytes before the entries of an index page.
const PAGE_HEAD_BYTES: usize = 16;
/// Longest chunk in bytes.
pub const MAX_CHUNK_BYTES: u32 = 1 << 28;

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

impl Entry {
    /// The stretch of the file.
    #[must_use]
    pub fn range(&self) -> Range<u64> {
        self.offset..self.offset + u64::from(self.bytes)
    }

    /// Checks the bytes of the chunk, which `field` names in the error.
    pub fn check(&self, field: &str, chunk: &[u8]) -> Result<(), PackError> {
        check_crc(field, chunk, self.crc32c)
    }
}

/// Where the bytes of a unit lie in the file, as far as that is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UnitPlace {
    /// Here.
    At(Entry),
    /// Where a page of the index says, which has to be loaded first.
    OnPage {
        /// Its number.
        page: u32,
        /// The stretch of the file that it fills.
        range: Range<u64>,
    },
    /// Nowhere: its page of the index is damaged.
    Lost,
}

impl UnitPlace {
    /// Where exactly, and the checksum; `field` names the chunk in the error.
    ///
    /// # Errors
    /// That is not known.
    pub fn known(self, field: &str) -> Result<Entry, PackError> {
        let found = match self {
            Self::At(entry) => return Ok(entry),
            Self::OnPage { page, .. } => format!("index page {page} not loaded"),
            Self::Lost => "a damaged index page".to_owned(),
        };
        Err(PackError::new(field, found, "a known place"))
    }
}

/// How the units of a pack are numbered: levels follow each other from the coarsest to the finest,
/// and each begins a page of the index.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitNumbers {
    /// First unit of each level, by level.
    first: Vec<u32>,
    units: u32,
    /// Entries of a full page.
    page: u32,
}

impl UnitNumbers {
    /// The numbers of content with so many units of each level, finest first. Refuses 2^32 units
    /// and more.
    pub fn new(units_of_levels: &[u64]) -> Result<Self, PackError> {
        Self::in_pages_of(PAGE_ENTRIES, units_of_levels)
    }

    /// The same where a full page of the index has so many entries, at least one.
    pub fn in_pages_of(page: u32, units_of_levels: &[u64]) -> Result<Self, PackError> {
        let mut first = vec![0; units_of_levels.len()];
        let mut units = 0u64;
        for (level, of_level) in units_of_levels.iter().enumerate().rev() {
            first[level] = units as u32;
            units = units.saturating_add(*of_level);
            if units > u64::from(u32::MAX) {
                return Err(PackError::new(
                    "units",
                    units,
                    "fewer than 2^32: use larger tiles",
                ));
            }
        }
        Ok(Self {
            first,
            units: units as u32,
            page: page.max(1),
        })
    }

    /// Number of units of all levels.
    #[must_use]
    pub fn units(&self) -> u32 {
        self.units
    }

    /// The first unit of a level.
    #[must_use]
    pub fn first_of(&self, level: u8) -> UnitId {
        UnitId(self.first[usize::from(level)])
    }

    /// The level of a unit, 0 the finest.
    ///
    /// # Panics
    /// The unit must exist.
    #[must_use]
    pub fn level_of(&self, unit: UnitId) -> u8 {
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
            let of_level = entries.div_ceil(self.page);
            (pages + of_level, bytes + self.bytes_of(entries))
        })
    }

    /// The page that holds a unit's entry.
    #[must_use]
    pub fn page_of(&self, unit: UnitId) -> u32 {
        let level = usize::from(self.level_of(unit));
        self.before(level).0 + (unit.0 - self.first[level]) / self.page
    }

    /// The units of a page, and where its bytes are in the index; `None` beyond the last.
    fn page(&self, page: u32) -> Option<(Range<u32>, Range<u64>)> {
        let levels = 0..self.first.len();
        // Levels follow each other from the coarsest, which has the highest number.
        let level = levels.rev().rfind(|&level| self.before(level).0 <= page)?;
        let (pages, bytes) = self.before(level);
        let within = u64::from(page - pages) * u64::from(self.page);
        let from = u64::from(self.first[level]) + within;
        let end = u64::from(self.end(level));
        if from >= end {
            return None;
        }
        let units = from as u32..end.min(from + u64::from(self.page)) as u32;
        let begin = bytes + u64::from(page - pages) * self.bytes_of(self.page);
        let end = begin + self.bytes_of(units.len() as u32);
        Some((units, begin..end))
    }

    /// Units of each page of the index, in file order.
    #[must_use]
    pub fn pages(&self) -> Vec<Range<u32>> {
        let mut pages = Vec::new();
        for level in (0..self.first.len()).rev() {
            let end = self.end(level);
            let mut from = self.first[level];
            while from < end {
                let to = end.min(from + self.page);
                pages.push(from..to);
                from = to;
            }
        }
        pages
    }

    /// Bytes of the whole index.
    #[must_use]
    pub fn index_bytes(&self) -> u64 {
        // Every level begins a page, so count whole levels instead of building the page list of
        // bytes that are not checked yet.
        (0..self.first.len())
            .map(|level| self.bytes_of(self.end(level) - self.first[level]))
            .sum()
    }

    /// Bytes of the index that a level's entries take.
    fn bytes_of(&self, entries: u32) -> u64 {
        let pages = entries.div_ceil(self.page);
        u64::from(entries) * ENTRY_BYTES as u64 + u64::from(pages) * PAGE_HEAD_BYTES as u64
    }

    /// The bytes of a page of the index: its head with its checksum, then its entries.
    pub(super) fn write_page(page: u32, units: Range<u32>, entries: &[Entry]) -> Vec<u8> {
        let mut rows = Vec::with_capacity(entries.len() * ENTRY_BYTES);
        for entry in entries {
            rows.extend_from_slice(&entry.offset.to_le_bytes());
            rows.extend_from_slice(&entry.bytes.to_le_bytes());
            rows.extend_from_slice(&entry.crc32c.to_le_bytes());
        }
        let head = [page, units.start, units.len() as u32];
        let mut bytes: Vec<u8> = head.iter().flat_map(|word| word.to_le_bytes()).collect();
        let crc = crc32c::crc32c_append(crc32c::crc32c(&bytes), &rows);
        bytes.extend_from_slice(&crc.to_le_bytes());
        bytes.extend_from_slice(&rows);
        bytes
    }
}

/// The index of a pack.
///
/// Its pages may be loaded in any order, as a reader over a network asks for them, and by any of
/// those who share it; an entry is known once its page is loaded.
#[derive(Clone, Debug, PartialEq)]
pub struct Index {
    numbers: UnitNumbers,
    /// Where chunks lie.
    data: Range<u64>,
    offset: u64,
    pages: Box<[OnceLock<Box<[Entry]>>]>,
}

impl Index {
    /// The index of a pack whose header is `header`, without any of its pages. Refuses a header
    /// that gives another length than the numbers need.
    pub fn new(header: &Header, numbers: UnitNumbers) -> Result<Self, PackError> {
        if header.index_bytes != numbers.index_bytes() {
            let found = counted(header.index_bytes, "byte");
            return Err(wrong_length(&numbers, found));
        }
        let last = numbers.units.checked_sub(1);
        let pages = last.map_or(0, |last| numbers.page_of(UnitId(last)) + 1);
        Ok(Self {
            data: header.data_offset()..header.index_offset,
            offset: header.index_offset,
            pages: (0..pages).map(|_| OnceLock::new()).collect(),
            numbers,
        })
    }

    /// Reads all pages. Refuses what [`Self::add_page`] refuses, and another length.
    pub fn add_all(&self, bytes: &[u8]) -> Result<(), PackError> {
        if bytes.len() as u64 != self.numbers.index_bytes() {
            return Err(wrong_length(&self.numbers, counted(bytes.len(), "byte")));
        }
        let mut at = 0;
        for (number, units) in self.numbers.pages().into_iter().enumerate() {
            let length = self.numbers.bytes_of(units.len() as u32) as usize;
            self.add_page(number as u32, &bytes[at..at + length])?;
            at += length;
        }
        Ok(())
    }

    /// Reads page after page by `read`, which receives where in the file each lies; each is checked
    /// before the next is read.
    ///
    /// # Errors
    /// What `read` refuses, and what [`Self::add_page`] does, as `wrong` reports it.
    pub fn read_all<E>(
        &self,
        mut read: impl FnMut(Range<u64>) -> Result<Vec<u8>, E>,
        wrong: impl Fn(PackError) -> E,
    ) -> Result<(), E> {
        for page in 0..self.pages() {
            if let Some(place) = self.page_place(page) {
                let bytes = read(place)?;
                self.add_page(page, &bytes).map_err(&wrong)?;
            }
        }
        Ok(())
    }

    /// Takes the bytes of a page, wherever among the others it comes. Refuses a wrong checksum,
    /// another page, and entries outside the chunks' part of the file or longer than
    /// [`MAX_CHUNK_BYTES`].
    pub fn add_page(&self, page: u32, bytes: &[u8]) -> Result<(), PackError> {
        let field = format!("index page {page}");
        let wrong = |found: String, expected: &str| PackError::new(&field, found, expected);
        let Some((units, place)) = self.numbers.page(page) else {
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
        // A page that was loaded already says the same.
        let _ = self.pages[page as usize].set(entries);
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

    /// How units are numbered.
    #[must_use]
    pub fn numbers(&self) -> &UnitNumbers {
        &self.numbers
    }

    /// All units, coarsest level first.
    pub fn units(&self) -> impl ExactSizeIterator<Item = UnitId> + use<> {
        (0..self.numbers.units as usize).map(|unit| UnitId(unit as u32))
    }

    /// Where in the file a page of the index lies; `None` beyond the last.
    #[must_use]
    pub fn page_place(&self, page: u32) -> Option<Range<u64>> {
        let (_, place) = self.numbers.page(page)?;
        Some(self.offset + place.start..self.offset + place.end)
    }

    /// Number of pages.
    #[must_use]
    pub fn pages(&self) -> u32 {
        self.pages.len() as u32
    }

    /// Whether a page has been loaded.
    #[must_use]
    pub fn has_page(&self, page: u32) -> bool {
        let page = self.pages.get(page as usize);
        page.is_some_and(|page| page.get().is_some())
    }

    /// Where the chunk of a unit lies, or the page that says so. O(1).
    ///
    /// # Panics
    /// There must be such a unit.
    #[must_use]
    pub fn place(&self, unit: UnitId) -> UnitPlace {
        if let Some(entry) = self.known_entry(unit) {
            return UnitPlace::At(entry);
        }
        let page = self.numbers.page_of(unit);
        let range = self.page_place(page);
        range.map_or(UnitPlace::Lost, |range| UnitPlace::OnPage { page, range })
    }

    /// Place and checksum of a unit's chunk, where its page has been loaded. O(1).
    #[must_use]
    pub(crate) fn known_entry(&self, unit: UnitId) -> Option<Entry> {
        let level = self.numbers.level_of(unit);
        let within = (unit.0 - self.numbers.first_of(level).0) % self.numbers.page;
        let page = self.pages.get(self.numbers.page_of(unit) as usize)?.get()?;
        page.get(within as usize).copied()
    }

    /// Place and checksum of a unit's chunk. O(1).
    ///
    /// # Panics
    /// Its page of the index must have been loaded.
    #[must_use]
    pub fn entry(&self, unit: UnitId) -> Entry {
        let entry = self.known_entry(unit);
        assert!(entry.is_some(), "the page of unit {} is not there", unit.0);
        entry.unwrap_or_default()
    }

    /// Bytes of all chunks of each level, finest first.
    #[must_use]
    pub fn bytes_per_level(&self) -> Vec<u64> {
        let mut bytes = vec![0; self.numbers.first.len()];
        for unit in self.units() {
            bytes[usize::from(self.numbers.level_of(unit))] += u64::from(self.entry(unit).bytes);
        }
        bytes
    }

    /// Whether chunks and side tables fill the file without gap or overlap, so that every byte is
    /// under some checksum.
    pub fn check_coverage(&self, header: &Header, tables: &[TableEntry]) -> Result<(), PackError> {
        let entries = self.units().map(|unit| self.entry(unit));
        let chunks = entries.map(|e| (e.offset, u64::from(e.bytes))).collect();
        check_filled("chunks", chunks, header.data_offset()..header.index_offset)?;
        let tables = tables.iter().map(|t| (t.offset, t.bytes)).collect();
        let after_index = header.index_offset + header.index_bytes;
        check_filled("side tables", tables, after_index..header.file_bytes)
    }
}

fn wrong_length(numbers: &UnitNumbers, found: String) -> PackError {
    PackError::new("index", found, counted(numbers.index_bytes(), "byte"))
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
    check_crc_of(&field, found, u32_at(head, 12))?;
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
