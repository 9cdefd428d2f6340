//! What do the bytes of a pack mean?
//!
//! `docs/formats/pack.md` is normative. Everything here works on slices: whoever reads the file, a
//! byte range of a web server or a socket hands the bytes in and learns which to fetch next. Bytes
//! are never trusted: every length is checked before anything is allocated.

mod build;
mod description;
mod index;
mod journal;
mod needs;
#[cfg(test)]
mod tests;

pub use build::{PackBuilder, PackHead, SideTable};
pub use description::{Description, Loss, Source, TableEntry};
pub use index::{Entry, Pack, split_chunk};
pub use journal::{
    Difference, Identity, JOURNAL_MAGIC, Journal, PlacedChunk, Step, read_any_journal,
};

use crate::units::counted;
use thiserror::Error;

/// The first eight bytes of every pack; the line end shows transfers that change line ends.
pub const MAGIC: [u8; 8] = *b"FOVEAL\r\n";
/// Version of the format that this program reads and writes.
pub const VERSION: u32 = 1;
/// Bytes of the fixed header.
pub const HEADER_BYTES: usize = 64;
/// Index entries in a full page.
pub const PAGE_ENTRIES: usize = 1024;
/// Bytes of one index entry.
pub const ENTRY_BYTES: usize = 16;
/// Bytes before the entries of an index page.
pub const PAGE_HEAD_BYTES: usize = 16;
/// Longest description in bytes that is read.
pub const MAX_DESCRIPTION_BYTES: u32 = 1 << 20;
/// Most frames in a pack.
pub const MAX_FRAMES: u32 = 1 << 24;
/// Longest group in frames.
pub const MAX_GROUP: u32 = 1024;
/// Longest chunk in bytes.
pub const MAX_CHUNK_BYTES: u32 = 1 << 28;

/// Why bytes are no pack, or a damaged one: which field, what was found, what was expected.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{field}: found {found}, expected {expected}")]
pub struct PackError {
    /// The field of the format, as `docs/formats/pack.md` names it.
    pub field: String,
    /// What the bytes say.
    pub found: String,
    /// What they should say.
    pub expected: String,
}

impl PackError {
    pub(crate) fn new(field: &str, found: impl ToString, expected: impl ToString) -> Self {
        Self {
            field: field.to_owned(),
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    fn checksum(field: &str, found: u32, expected: u32) -> Self {
        Self::new(
            field,
            format!("CRC32C {found:08x}"),
            format!("{expected:08x} (damaged bytes)"),
        )
    }
}

/// Checks `bytes` against the CRC32C that was written for them; `field` names them in the error.
pub fn check_crc(field: &str, bytes: &[u8], expected: u32) -> Result<(), PackError> {
    let found = crc32c::crc32c(bytes);
    if found == expected {
        Ok(())
    } else {
        Err(PackError::checksum(field, found, expected))
    }
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(word)
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(word)
}

/// The fixed header: where everything else lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Bytes of the description, which follows the header.
    pub description_bytes: u32,
    /// CRC32C of the description.
    pub description_crc: u32,
    /// Where the index begins; chunks fill the file from the description to here.
    pub index_offset: u64,
    /// Bytes of the index; side tables fill the file from its end.
    pub index_bytes: u64,
    /// Bytes of the whole file.
    pub file_bytes: u64,
}

impl Header {
    /// Reads the first [`HEADER_BYTES`] of a pack.
    pub fn parse(bytes: &[u8]) -> Result<Self, PackError> {
        let begin = &bytes[..bytes.len().min(MAGIC.len())];
        if !MAGIC.starts_with(begin) {
            return Err(PackError::new(
                "magic",
                begin.escape_ascii(),
                "FOVEAL\\r\\n (this is no pack)",
            ));
        }
        if bytes.len() < HEADER_BYTES {
            let found = counted(bytes.len(), "byte");
            return Err(PackError::new("header", found, "at least 64 bytes"));
        }
        let version = u32_at(bytes, 8);
        if version != VERSION {
            return Err(wrong_version(version));
        }
        check_crc("header", &bytes[..60], u32_at(bytes, 60))?;
        let header = Self {
            description_bytes: u32_at(bytes, 12),
            description_crc: u32_at(bytes, 16),
            index_offset: u64_at(bytes, 24),
            index_bytes: u64_at(bytes, 32),
            file_bytes: u64_at(bytes, 40),
        };
        if header.description_bytes > MAX_DESCRIPTION_BYTES {
            let most = format!("at most {MAX_DESCRIPTION_BYTES}");
            return Err(PackError::new(
                "description_bytes",
                header.description_bytes,
                most,
            ));
        }
        let index_end = header.index_offset.checked_add(header.index_bytes);
        if header.index_offset < header.data_offset()
            || index_end.is_none_or(|end| end > header.file_bytes)
        {
            let found = format!("{}+{}", header.index_offset, header.index_bytes);
            let expected = format!("{}..{}", header.data_offset(), header.file_bytes);
            return Err(PackError::new("index_offset, index_bytes", found, expected));
        }
        Ok(header)
    }

    /// The header as bytes, checksum included.
    #[must_use]
    pub fn write(&self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[..8].copy_from_slice(&MAGIC);
        bytes[8..12].copy_from_slice(&VERSION.to_le_bytes());
        bytes[12..16].copy_from_slice(&self.description_bytes.to_le_bytes());
        bytes[16..20].copy_from_slice(&self.description_crc.to_le_bytes());
        bytes[24..32].copy_from_slice(&self.index_offset.to_le_bytes());
        bytes[32..40].copy_from_slice(&self.index_bytes.to_le_bytes());
        bytes[40..48].copy_from_slice(&self.file_bytes.to_le_bytes());
        let crc = crc32c::crc32c(&bytes[..60]);
        bytes[60..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }

    /// Where the first chunk begins.
    #[must_use]
    pub fn data_offset(&self) -> u64 {
        HEADER_BYTES as u64 + u64::from(self.description_bytes)
    }
}

/// Says what to do about a pack of another version.
fn wrong_version(version: u32) -> PackError {
    let why = if version > VERSION {
        "a newer foveal wrote this pack: update foveal"
    } else {
        "damaged bytes: copy the pack again"
    };
    PackError::new("version", version, format!("{VERSION}; {why}"))
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
    let Ok(pack) = Pack::parse(&header, description, index) else {
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
