//! Which bytes does a new pack begin and end with?

use super::error::PackError;
use super::header::{HEADER_BYTES, Header};
use super::index::{Entry, UnitNumbers};
use super::journal::{ChunkName, PlacedChunk};
use super::tables::{SideTable, TableEntry};
use super::unit::UnitId;
use crate::units::counted;

/// Spaces kept free in the description for what is only known at the end: the entries of side
/// tables, numbers that were counted, what preparing lost.
const DESCRIPTION_ROOM: usize = 2048;

/// What comes before and after the chunks of a finished pack.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PackHead {
    /// Header and description, to be written at the start of the file.
    pub head: Vec<u8>,
    /// Index and side tables, to be written after the last chunk.
    pub tail: Vec<u8>,
}

/// Collects where chunks were written and turns it into the rest of the file.
///
/// How many units there are may be unknown until the end: chunks are noted by the name that their
/// content gives them.
#[derive(Debug)]
pub struct PackBuilder {
    data_offset: u64,
    at: u64,
    chunks: Vec<(ChunkName, Entry)>,
}

impl PackBuilder {
    /// A pack that will have about this description; only its length matters here.
    #[must_use]
    pub fn new(draft: &[u8]) -> Self {
        let room = (draft.len() + DESCRIPTION_ROOM).next_multiple_of(4096) - HEADER_BYTES;
        let data_offset = (HEADER_BYTES + room) as u64;
        Self {
            data_offset,
            at: data_offset,
            chunks: Vec::new(),
        }
    }

    /// Where the first chunk is to be written.
    #[must_use]
    pub fn data_offset(&self) -> u64 {
        self.data_offset
    }

    /// Notes the next chunk, which is written right after the one before.
    pub fn push(&mut self, name: ChunkName, chunk: &[u8]) {
        self.take_up(PlacedChunk {
            name,
            bytes: chunk.len() as u32,
            crc32c: crc32c::crc32c(chunk),
        });
    }

    /// Notes the next chunk, which lies in the file already.
    pub fn take_up(&mut self, chunk: PlacedChunk) {
        let entry = Entry {
            offset: self.at,
            bytes: chunk.bytes,
            crc32c: chunk.crc32c,
        };
        self.at += u64::from(chunk.bytes);
        self.chunks.push((chunk.name, entry));
    }

    /// Number of chunks noted so far.
    #[must_use]
    pub fn len(&self) -> usize {
        self.chunks.len()
    }

    /// Whether no chunk was noted.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.chunks.is_empty()
    }

    /// Where the next chunk is to be written.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.at
    }

    /// The chunks noted after the first `count`.
    #[must_use]
    pub fn chunks_after(&self, count: usize) -> Vec<PlacedChunk> {
        let placed = |(name, entry): &(ChunkName, Entry)| PlacedChunk {
            name: *name,
            bytes: entry.bytes,
            crc32c: entry.crc32c,
        };
        self.chunks[count..].iter().map(placed).collect()
    }

    /// The bytes before and after the chunks. `unit_of` numbers them by `numbers`, whose units must
    /// all have been noted once, or the error says which is missing; `describe` writes the
    /// description with these side tables.
    pub fn finish(
        self,
        numbers: &UnitNumbers,
        unit_of: impl Fn(ChunkName) -> UnitId,
        tables: &[SideTable],
        describe: impl FnOnce(Vec<TableEntry>) -> Result<Vec<u8>, PackError>,
    ) -> Result<PackHead, PackError> {
        let mut tail = self.index(numbers, unit_of)?;
        let index_bytes = tail.len() as u64;
        let mut entries = Vec::new();
        for table in tables {
            entries.push(entry_of(table, self.at + tail.len() as u64));
            tail.extend_from_slice(&table.bytes);
        }
        let header = Header {
            description_bytes: (self.data_offset - HEADER_BYTES as u64) as u32,
            description_crc: 0,
            index_offset: self.at,
            index_bytes,
            file_bytes: self.at + tail.len() as u64,
        };
        let head = head_of(describe(entries)?, header)?;
        Ok(PackHead { head, tail })
    }

    fn index(
        &self,
        numbers: &UnitNumbers,
        unit_of: impl Fn(ChunkName) -> UnitId,
    ) -> Result<Vec<u8>, PackError> {
        let mut entries = vec![None; numbers.units() as usize];
        for (name, entry) in &self.chunks {
            let UnitId(unit) = unit_of(*name);
            if entries[unit as usize].replace(*entry).is_some() {
                return Err(PackError::new(
                    "chunks",
                    format!("unit {unit} twice"),
                    "once",
                ));
            }
        }
        let mut index = Vec::new();
        for (number, units) in numbers.pages().into_iter().enumerate() {
            let known = |unit: u32| {
                let found = || format!("no unit {unit}");
                let missing = || PackError::new("chunks", found(), "all units");
                entries[unit as usize].ok_or_else(missing)
            };
            let page: Vec<Entry> = units.clone().map(known).collect::<Result<_, _>>()?;
            index.extend_from_slice(&UnitNumbers::write_page(number as u32, units, &page));
        }
        Ok(index)
    }
}

impl PackHead {
    /// The same with another description, in as much room.
    pub fn described_as(self, json: Vec<u8>) -> Result<Self, PackError> {
        let head = head_of(json, Header::parse(&self.head)?)?;
        Ok(Self { head, ..self })
    }

    /// The same without the side table of this entry, which must lie behind all others; its bytes
    /// are still in the tail.
    pub(crate) fn without_last(mut self, entry: &TableEntry) -> Result<Self, PackError> {
        let header = Header::parse(&self.head)?;
        let header = Header {
            file_bytes: header.file_bytes - entry.bytes,
            ..header
        };
        let json = self.head.split_off(HEADER_BYTES);
        let head = head_of(json, header)?;
        Ok(Self { head, ..self })
    }

    /// The same with another side table behind all others. `describe` writes the description with
    /// its entry, in as much room.
    pub fn with_table(
        mut self,
        table: &SideTable,
        describe: impl FnOnce(TableEntry) -> Result<Vec<u8>, PackError>,
    ) -> Result<Self, PackError> {
        let mut header = Header::parse(&self.head)?;
        let entry = entry_of(table, header.file_bytes);
        header.file_bytes += entry.bytes;
        self.tail.extend_from_slice(&table.bytes);
        let head = head_of(describe(entry)?, header)?;
        Ok(Self { head, ..self })
    }
}

/// The entry of a side table that lies at `offset`.
fn entry_of(table: &SideTable, offset: u64) -> TableEntry {
    TableEntry {
        name: table.name.clone(),
        version: table.version,
        offset,
        bytes: table.bytes.len() as u64,
        crc32c: crc32c::crc32c(&table.bytes),
    }
}

/// Header and description of a pack whose parts lie where `header` says.
fn head_of(mut json: Vec<u8>, header: Header) -> Result<Vec<u8>, PackError> {
    let room = header.description_bytes as usize;
    if json.len() > room {
        let expected = format!("at most the {room} kept free at the start");
        return Err(PackError::new(
            "description",
            counted(json.len(), "byte"),
            expected,
        ));
    }
    json.resize(room, b' ');
    let header = Header {
        description_crc: crc32c::crc32c(&json),
        ..header
    };
    let mut head = header.write().to_vec();
    head.extend_from_slice(&json);
    Ok(head)
}
