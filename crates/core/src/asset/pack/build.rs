//! Which bytes does a new pack begin and end with?

use super::{
    Description, Entry, HEADER_BYTES, Header, Loss, PackError, PlacedChunk, TableEntry,
    index::Layout, needs::Written,
};
use crate::asset::tile_grid::Tile;
use crate::asset::unit::UnitId;
use crate::units::counted;

/// Spaces kept free in the description for the side tables' entries, the final frame count and what
/// preparing lost.
const DESCRIPTION_ROOM: usize = 2048;

/// A side table to be written after the index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SideTable {
    /// What it holds.
    pub name: String,
    /// Version of its layout.
    pub version: u32,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

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
/// The number of frames may be unknown until the end: chunks are placed by tile and first frame.
#[derive(Debug)]
pub struct PackBuilder {
    data_offset: u64,
    at: u64,
    chunks: Vec<(Tile, u32, Entry)>,
}

impl PackBuilder {
    /// A pack that will have about this description; only its length matters here.
    #[must_use]
    pub fn new(draft: &Description) -> Self {
        let json = serde_json::to_vec(draft).unwrap_or_default();
        let room = (json.len() + DESCRIPTION_ROOM).next_multiple_of(4096) - HEADER_BYTES;
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

    /// Notes the next chunk, which is written right after the one before: the access units of
    /// `tile` from `first_frame` on. Returns its bytes.
    pub fn push(&mut self, tile: Tile, first_frame: u32, access_units: &[Vec<u8>]) -> Vec<u8> {
        let mut chunk = Vec::new();
        for unit in access_units {
            chunk.extend_from_slice(&(unit.len() as u32).to_le_bytes());
        }
        access_units
            .iter()
            .for_each(|unit| chunk.extend_from_slice(unit));
        self.take_up(PlacedChunk {
            tile,
            first_frame,
            bytes: chunk.len() as u32,
            crc32c: crc32c::crc32c(&chunk),
        });
        chunk
    }

    /// Notes the next chunk, which lies in the file already.
    pub fn take_up(&mut self, chunk: PlacedChunk) {
        let entry = Entry {
            offset: self.at,
            bytes: chunk.bytes,
            crc32c: chunk.crc32c,
        };
        self.at += u64::from(chunk.bytes);
        self.chunks.push((chunk.tile, chunk.first_frame, entry));
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
        let placed = |(tile, first_frame, entry): &(Tile, u32, Entry)| PlacedChunk {
            tile: *tile,
            first_frame: *first_frame,
            bytes: entry.bytes,
            crc32c: entry.crc32c,
        };
        self.chunks[count..].iter().map(placed).collect()
    }

    /// The bytes before and after the chunks. Every unit of `description` must have been pushed
    /// once, or the error says which is missing.
    pub fn finish(
        self,
        mut description: Description,
        tables: &[SideTable],
    ) -> Result<PackHead, PackError> {
        description.tables.clear();
        description.check()?;
        let layout = Layout::new(&description)?;
        let mut entries = vec![None; layout.units as usize];
        for (tile, first_frame, entry) in &self.chunks {
            let UnitId(unit) = layout.unit(*tile, *first_frame);
            if entries[unit as usize].replace(*entry).is_some() {
                return Err(PackError::new(
                    "chunks",
                    format!("unit {unit} twice"),
                    "once",
                ));
            }
        }
        let mut tail = Vec::new();
        for (number, units) in layout.pages().into_iter().enumerate() {
            let mut page = Vec::new();
            for unit in units.clone() {
                let Some(entry) = entries[unit as usize] else {
                    return Err(PackError::new(
                        "chunks",
                        format!("no unit {unit}"),
                        "all units",
                    ));
                };
                page.extend_from_slice(&entry.offset.to_le_bytes());
                page.extend_from_slice(&entry.bytes.to_le_bytes());
                page.extend_from_slice(&entry.crc32c.to_le_bytes());
            }
            let head = [number as u32, units.start, units.len() as u32];
            let head: Vec<u8> = head.iter().flat_map(|word| word.to_le_bytes()).collect();
            let crc = crc32c::crc32c_append(crc32c::crc32c(&head), &page);
            tail.extend_from_slice(&head);
            tail.extend_from_slice(&crc.to_le_bytes());
            tail.extend_from_slice(&page);
        }
        let index_bytes = tail.len() as u64;
        for table in tables {
            description.tables.push(TableEntry {
                name: table.name.clone(),
                version: table.version,
                offset: self.at + tail.len() as u64,
                bytes: table.bytes.len() as u64,
                crc32c: crc32c::crc32c(&table.bytes),
            });
            tail.extend_from_slice(&table.bytes);
        }
        let header = Header {
            description_bytes: (self.data_offset - HEADER_BYTES as u64) as u32,
            description_crc: 0,
            index_offset: self.at,
            index_bytes,
            file_bytes: self.at + tail.len() as u64,
        };
        let head = head_of(&description, header)?;
        Ok(PackHead { head, tail })
    }
}

impl PackHead {
    /// The same with what preparing lost, which only a finished pack shows; as long as before.
    pub fn with_loss(self, loss: Loss) -> Result<Self, PackError> {
        let description = Description {
            loss: Some(loss),
            ..Description::parse(&self.head[HEADER_BYTES..])?
        };
        description.check()?;
        let head = head_of(&description, Header::parse(&self.head)?)?;
        Ok(Self { head, ..self })
    }
}

/// Header and description of a pack whose parts lie where `header` says.
fn head_of(description: &Description, header: Header) -> Result<Vec<u8>, PackError> {
    let mut json = serde_json::to_vec(&Written::new(description))
        .map_err(|e| PackError::new("description", e, "valid JSON"))?;
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
