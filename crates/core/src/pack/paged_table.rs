//! How is a side table read page by page, where its rows differ in length?
//!
//! A directory opens the table and lists every page; a page is checked by itself. Normative:
//! docs/formats/pack.md, "Tables in pages".

use super::error::{PackError, check_crc, u32_at};
use crate::units::counted;
use core::ops::Range;

/// Bytes before the directory: the number of pages, and the directory's checksum.
pub const TABLE_HEAD_BYTES: usize = 8;
/// Bytes of the directory for each page.
const DIRECTORY_ROW: usize = 12;

/// Where the pages of a table are, and which rows they hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageDirectory {
    pages: Vec<Page>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Page {
    rows: Range<u32>,
    /// Within the table.
    place: Range<u64>,
    crc32c: u32,
}

impl PageDirectory {
    /// Bytes from the start of a table to its first page, by the first [`TABLE_HEAD_BYTES`] of it.
    ///
    /// # Panics
    /// There must be as many bytes.
    #[must_use]
    pub fn bytes(head: &[u8]) -> u64 {
        TABLE_HEAD_BYTES as u64 + u64::from(u32_at(head, 0)) * DIRECTORY_ROW as u64
    }

    /// Reads the directory at the start of a table of `table_bytes` with so many rows. Refuses a
    /// wrong checksum, and pages that do not hold all rows in order or do not fill the table.
    pub fn parse(bytes: &[u8], rows: u32, table_bytes: u64) -> Result<Self, PackError> {
        let wrong = |found: String, expected: String| {
            Err(PackError::new("directory of a table", found, expected))
        };
        let length = bytes.get(..TABLE_HEAD_BYTES).map(Self::bytes);
        let length = length.filter(|length| *length <= bytes.len() as u64);
        let Some(length) = length else {
            let expected = "a directory of its pages".to_owned();
            return wrong(counted(bytes.len(), "byte"), expected);
        };
        let directory = &bytes[TABLE_HEAD_BYTES..length as usize];
        check_crc("directory of a table", directory, u32_at(bytes, 4))?;
        let (mut pages, mut at) = (Vec::new(), length);
        let entries: Vec<&[u8]> = directory.chunks_exact(DIRECTORY_ROW).collect();
        for (number, entry) in entries.iter().enumerate() {
            let first = u32_at(entry, 0);
            let end = entries.get(number + 1).map_or(rows, |it| u32_at(it, 0));
            let follows = match pages.last() {
                Some(Page { rows, .. }) => rows.end == first,
                None => first == 0,
            };
            if !follows || first >= end || end > rows {
                return wrong(format!("rows {first} to {end}"), format!("all of {rows}"));
            }
            let place = at..at + u64::from(u32_at(entry, 4));
            at = place.end;
            pages.push(Page {
                rows: first..end,
                place,
                crc32c: u32_at(entry, 8),
            });
        }
        if at != table_bytes || (pages.is_empty() && rows > 0) {
            return wrong(format!("pages to byte {at}"), table_bytes.to_string());
        }
        Ok(Self { pages })
    }

    /// Number of pages.
    #[must_use]
    pub fn len(&self) -> u32 {
        self.pages.len() as u32
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pages.is_empty()
    }

    /// The page that holds a row; `None` beyond the last.
    #[must_use]
    pub fn page_of(&self, row: u32) -> Option<u32> {
        let page = self.pages.partition_point(|page| page.rows.end <= row);
        (page < self.pages.len()).then_some(page as u32)
    }

    /// The rows of a page.
    ///
    /// # Panics
    /// There must be such a page.
    #[must_use]
    pub fn rows(&self, page: u32) -> Range<u32> {
        self.pages[page as usize].rows.clone()
    }

    /// Where the bytes of a page are, counted from the start of the table.
    ///
    /// # Panics
    /// There must be such a page.
    #[must_use]
    pub fn place(&self, page: u32) -> Range<u64> {
        self.pages[page as usize].place.clone()
    }

    /// Checks the bytes of a page against its checksum and length.
    ///
    /// # Panics
    /// There must be such a page.
    pub fn check(&self, page: u32, bytes: &[u8]) -> Result<(), PackError> {
        let field = format!("page {page} of a table");
        let Page { place, crc32c, .. } = &self.pages[page as usize];
        let length = place.end - place.start;
        if bytes.len() as u64 != length {
            let found = counted(bytes.len(), "byte");
            return Err(PackError::new(&field, found, counted(length, "byte")));
        }
        check_crc(&field, bytes, *crc32c)
    }
}

/// A table of rows, given in order, with so many rows in a page; `starts` says at which rows a page
/// begins whatever the one before holds.
#[must_use]
pub fn write_pages(rows: &[Vec<u8>], page_rows: u32, starts: &[u32]) -> Vec<u8> {
    let (mut directory, mut pages, mut first) = (Vec::new(), Vec::new(), 0);
    while first < rows.len() {
        let next = starts.iter().map(|start| *start as usize);
        let next = next.filter(|start| *start > first).min();
        let end = (first + page_rows as usize).min(next.unwrap_or(rows.len()));
        let page: Vec<u8> = rows[first..end].concat();
        let words = [first as u32, page.len() as u32, crc32c::crc32c(&page)];
        directory.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        pages.extend(page);
        first = end;
    }
    let count = (directory.len() / DIRECTORY_ROW) as u32;
    let head = [count, crc32c::crc32c(&directory)];
    let head = head.iter().flat_map(|word| word.to_le_bytes());
    head.chain(directory).chain(pages).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Vec<u8>> {
        (0..20u8)
            .map(|row| vec![row; usize::from(row % 5)])
            .collect()
    }

    fn read(table: &[u8]) -> Result<Vec<u8>, PackError> {
        let directory = PageDirectory::parse(table, 20, table.len() as u64)?;
        let mut all = Vec::new();
        for page in 0..directory.len() {
            let place = directory.place(page);
            let bytes = &table[place.start as usize..place.end as usize];
            directory.check(page, bytes)?;
            all.extend(bytes);
        }
        Ok(all)
    }

    #[test]
    fn a_table_comes_back_in_pages_and_every_flipped_byte_is_found() {
        let table = write_pages(&rows(), 6, &[0, 4]);
        let directory = PageDirectory::parse(&table, 20, table.len() as u64).unwrap();
        let pages: Vec<Range<u32>> = (0..directory.len()).map(|it| directory.rows(it)).collect();
        assert_eq!(pages, [0..4, 4..10, 10..16, 16..20]);
        assert_eq!(
            [3, 4, 19, 20].map(|row| directory.page_of(row)),
            [Some(0), Some(1), Some(3), None]
        );
        assert_eq!(read(&table).unwrap(), rows().concat());
        for place in 0..table.len() {
            let mut bad = table.clone();
            bad[place] ^= 0x40;
            assert!(read(&bad).is_err(), "byte {place}");
            assert!(read(&table[..place]).is_err(), "cut at {place}");
        }
    }

    #[test]
    fn a_directory_of_other_rows_is_refused() {
        let table = write_pages(&rows(), 6, &[]);
        for rows in [0, 19, 21] {
            let parsed = PageDirectory::parse(&table, rows, table.len() as u64);
            assert_eq!(parsed.is_ok(), rows == 19 || rows == 21, "{rows}");
        }
        assert!(PageDirectory::parse(&write_pages(&[], 6, &[]), 0, 8).is_ok());
        assert!(PageDirectory::parse(&write_pages(&[], 6, &[]), 1, 8).is_err());
    }
}
