//! Does any sequence of bytes, read as a pack, panic or allocate without bound?
//!
//! Random bytes rarely pass a checksum, so the same input also edits a good pack, whose checksums
//! are then made right again: what lies behind them is reached too.

#![no_main]

use foveal_core::content::video::bytes::build::{begin_pack, finish_pack, push_tile};
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::bytes::description::{Description, Source};
use foveal_core::content::video::bytes::pack::parse_anything;
use foveal_core::content::video::bytes::rate::QualityScale;
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::pack::{HEADER_BYTES, SideTable};
use foveal_core::view::picture::{Colour, Matrix};
use foveal_core::view::surface::{Mapping, Projection, Screen};
use libfuzzer_sys::fuzz_target;
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
    let description = Description {
        generator: String::new(),
        projection: Projection::Flat,
        size: [40, 24],
        eyes: 1,
        cube_faces: 6,
        mapping: Mapping::Gnomonic,
        pixel_aspect: [1, 1],
        front_deg: 0.0,
        cut: Cut::Tile(16),
        levels: 2,
        ratio: 2,
        codec: Codec::Png,
        quality: vec![0; 2],
        quality_scale: QualityScale::default(),
        bit_rates: Vec::new(),
        groups: vec![2, 4],
        frames: 5,
        frame_rate: [25, 1],
        colour: Colour {
            matrix: Matrix::Bt601,
            full_range: true,
            chroma_left: false,
        },
        source: Source {
            name: String::new(),
            size: [40, 24],
            bytes: 1,
            codec: String::new(),
        },
        identity: None,
        loss: None,
        last_frame_s: None,
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    };
    let grid = description.grid(Screen::default());
    let mut builder = begin_pack(&description);
    let mut chunks = Vec::new();
    for level in 0..2 {
        let group = description.groups[usize::from(level)];
        for first in (0..description.frames).step_by(group as usize) {
            let frames = group.min(description.frames - first);
            for tile in grid.tiles_of(level) {
                chunks.extend(push_tile(
                    &mut builder,
                    tile,
                    first,
                    &vec![vec![7; 3]; frames as usize],
                ));
            }
        }
    }
    let table = SideTable {
        name: "frame_times".to_owned(),
        version: 1,
        bytes: vec![0; 40],
    };
    let parts = finish_pack(builder, description, &[table]).expect("every unit was pushed");
    [parts.head, chunks, parts.tail].concat()
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
