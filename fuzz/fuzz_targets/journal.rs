//! Does any journal next to an unfinished pack panic, or read as what it does not say?

#![no_main]

use foveal_core::pack::{JOURNAL_MAGIC, read_any_journal};
use libfuzzer_sys::fuzz_target;

/// Blocks of the data under right lengths and checksums, which are hard to find.
fn sealed(data: &[u8]) -> Vec<u8> {
    let mut journal = JOURNAL_MAGIC.to_vec();
    let (first, rest) = data.split_at(data.first().map_or(0, |n| usize::from(*n)).min(data.len()));
    for payload in [first, rest] {
        journal.extend_from_slice(&(payload.len() as u32).to_le_bytes());
        journal.extend_from_slice(&crc32c::crc32c(payload).to_le_bytes());
        journal.extend_from_slice(payload);
    }
    journal
}

fuzz_target!(|data: &[u8]| {
    read_any_journal(data);
    read_any_journal(&sealed(data));
});
