//! What does a pack hold about units, besides their chunks?

use super::error::PackError;
use crate::units::counted;
use core::ops::Range;
use serde::{Deserialize, Serialize};

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

/// Where a side table lies, as the description says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableEntry {
    /// What it holds.
    pub name: String,
    /// Version of its layout.
    pub version: u32,
    /// First byte in the file.
    pub offset: u64,
    /// Its length in bytes.
    pub bytes: u64,
    /// Its checksum.
    pub crc32c: u32,
}

impl TableEntry {
    /// The stretch that it fills of a file of so many bytes.
    ///
    /// # Errors
    /// It reaches beyond the end.
    pub fn range(&self, file_bytes: u64) -> Result<Range<u64>, PackError> {
        let Self { offset, bytes, .. } = *self;
        let end = offset.checked_add(bytes).filter(|end| *end <= file_bytes);
        end.map(|end| offset..end).ok_or_else(|| {
            let within = format!("within {}", counted(file_bytes, "byte"));
            let field = format!("side table {}", self.name);
            PackError::new(&field, format!("{offset}+{bytes}"), within)
        })
    }
}
