//! Does any sequence of bytes, read as a pack, panic or allocate without bound?
//!
//! Random bytes rarely pass a checksum, so the same input also edits a good pack, whose checksums
//! are then made right again: what lies behind them is reached too.

#![no_main]

use foveal_core::content::video::bytes::pack::parse_anything;
use foveal_core::content::video::bytes::small_pack::{small_description, small_pack};
use foveal_core::pack::{HEADER_BYTES, SideTable};
use libfuzzer_sys::fuzz_target;
use std::ops::Range;
use std::sync::OnceLock;

static GOOD: OnceLock<Vec<u8>> = OnceLock::new();

fuzz_target!(|data: &[u8]| {
    let _ = parse_anything(data);
    let mut pack = GOOD.get_or_init(good_pack).clone();
    for edit in data.chunks_exact(3) {
        let place = usize::from(u16::from_le_bytes([edit[0], edit[1]])) % pack.len();
        pack[place] = edit[2];
    }
    repair_checksums(&mut pack);
    let _ = parse_anything(&pack);
});

fn good_pack() -> Vec<u8> {
    let table = SideTable {
        name: "frame_times".to_owned(),
        version: 1,
        bytes: vec![0; 40],
    };
    let about = small_description([40, 24], 16, &[2, 4], 5);
    let units = |_, frames: Range<u32>| vec![vec![7; 3]; frames.len()];
    small_pack(about, &[table], units).expect("every unit is pushed")
}

fn repair_checksums(pack: &mut [u8]) {
    let word = |pack: &[u8], at: usize| u32::from_le_bytes(pack[at..at + 4].try_into().unwrap());
    let end = HEADER_BYTES + word(pack, 12) as usize;
    if let Some(description) = pack.get(HEADER_BYTES..end) {
        let crc = crc32c::crc32c(description);
        pack[16..20].copy_from_slice(&crc.to_le_bytes());
    }
    let crc = crc32c::crc32c(&pack[..60]);
    pack[60..64].copy_from_slice(&crc.to_le_bytes());
    // The index of the good pack is two pages, one a level; each is 16 bytes and 16 an entry.
    let mut at = word(pack, 24) as usize;
    for _ in 0..2 {
        let Some(entries) = pack.get(at + 8..at + 12).map(|w| word(w, 0) as usize) else {
            return;
        };
        let Some(body) = pack.get(at + 16..at.saturating_add(16 + entries.min(4096) * 16)) else {
            return;
        };
        let crc = crc32c::crc32c_append(crc32c::crc32c(&pack[at..at + 12]), body);
        pack[at + 12..at + 16].copy_from_slice(&crc.to_le_bytes());
        at += 16 + entries.min(4096) * 16;
    }
}
