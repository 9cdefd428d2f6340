//! What does a pack hold about units, besides their chunks?

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
