//! What do the bytes of a pack mean, whatever is in it?
//!
//! `docs/formats/pack.md` is normative. Everything here works on slices: the caller reads the
//! file, a byte range of a web server or a socket, hands the bytes in and learns which to fetch
//! next. Bytes are never trusted: every length is checked before anything is allocated.

mod build;
mod error;
mod header;
mod index;
mod journal;
pub mod order;
pub mod paged_table;
mod tables;
pub mod unit;

pub use build::{PackBuilder, PackHead};
pub(crate) use error::u32_at;
pub use error::{PackError, check_crc};
pub use header::{HEADER_BYTES, Header, MAGIC, MAX_DESCRIPTION_BYTES, VERSION};
pub use index::{Entry, Index, MAX_CHUNK_BYTES, UnitNumbers, UnitPlace};
pub use journal::{
    ChunkName, Difference, Identity, JOURNAL_MAGIC, Journal, JournalStep, PlacedChunk,
    read_any_journal,
};
pub use tables::{SideTable, TableEntry};
pub use unit::sha256_hex;
