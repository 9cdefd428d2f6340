//! A pack from and to a file, and what an unfinished one is good for.

pub(crate) mod journal_file;
pub mod pack_file;
pub(crate) mod pack_writer;
