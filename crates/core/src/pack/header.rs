//! Where does everything lie in a pack?

use super::error::{PackError, check_crc, u32_at, u64_at};
use crate::units::counted;

/// The first eight bytes of every pack; the line end shows transfers that change line ends.
pub const MAGIC: [u8; 8] = *b"FOVEAL\r\n";
/// Version of the format that this program reads and writes.
pub const VERSION: u32 = 1;
/// Bytes of the fixed header.
pub const HEADER_BYTES: usize = 64;
/// Bytes of the header that say nothing yet.
const RESERVED: [core::ops::Range<usize>; 2] = [20..24, 48..60];
/// Longest description in bytes that is read.
pub const MAX_DESCRIPTION_BYTES: u32 = 1 << 20;

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
                "FOVEAL\\r\\n",
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
        for place in RESERVED {
            if let Some(found) = bytes[place.clone()].iter().find(|it| **it != 0) {
                let field = format!("reserved bytes {} to {}", place.start, place.end - 1);
                return Err(PackError::new(&field, found, "0"));
            }
        }
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
