//! Does any sequence of bytes, read as the pack of a scene, panic or allocate without bound?
//!
//! Random bytes rarely pass a checksum, so the same input also edits a good pack, whose checksums
//! are then made right again: description, index and rows of its table are reached too.

#![no_main]

#[path = "../../crates/core/tests/scene_packs/mod.rs"]
mod scene_packs;

use foveal_core::content::scene::pack::parse_anything;
use libfuzzer_sys::fuzz_target;
use std::sync::OnceLock;

static GOOD: OnceLock<Vec<u8>> = OnceLock::new();

fuzz_target!(|data: &[u8]| {
    let _ = parse_anything(data);
    let mut pack = GOOD.get_or_init(|| scene_packs::pack_of(|_| ())).clone();
    for edit in data.chunks_exact(3) {
        let place = usize::from(u16::from_le_bytes([edit[0], edit[1]])) % pack.len();
        pack[place] = edit[2];
    }
    scene_packs::repair_checksums(&mut pack);
    let _ = parse_anything(&pack);
});
