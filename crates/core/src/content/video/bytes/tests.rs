//! Does a pack read back as it was written, and is every damage found?

use super::build::{begin_pack, finish_pack, push_tile};
use super::chunk::split_chunk;
use super::description::{Description, Loss, MAX_FRAMES};
use super::pack::{VideoPack, numbers_of, parse_anything};
use super::small_pack::{open_file, small_description, small_pack};
use crate::content::video::bytes::rate::QualityScale;
use crate::content::video::grid::tile_grid::{Cut, Tile};
use crate::pack::unit::UnitId;
use crate::pack::{Entry, HEADER_BYTES, Header, Identity, SideTable, UnitPlace, check_crc, u32_at};
use crate::view::surface::{Mapping, Projection, Screen};
use std::ops::Range;

fn description() -> Description {
    small_description([100, 60], 32, &[2, 4, 4], 7)
}

/// A whole small pack with chunks of pseudo-random bytes.
fn pack_bytes() -> Vec<u8> {
    let table = SideTable {
        name: "frame_times".into(),
        version: 1,
        bytes: vec![5; 56],
    };
    let units = |tile: Tile, frames: Range<u32>| {
        let unit = |f: u32| vec![(f * 31 + u32::from(tile.x)) as u8; 3 + f as usize];
        (0..frames.len() as u32).map(unit).collect()
    };
    small_pack(description(), &[table], units).unwrap()
}

#[test]
fn a_pack_reads_back_as_it_was_written() {
    let bytes = pack_bytes();
    let (header, pack) = open_file(&bytes).unwrap();
    assert_eq!(header.file_bytes, bytes.len() as u64);
    pack.check_coverage(&header).unwrap();
    for unit in pack.units() {
        let (tile, frames) = (pack.tile_of(unit), pack.frames_of(unit));
        for frame in frames.clone() {
            assert_eq!(pack.unit(tile, frame), unit);
        }
        let entry = pack.entry(unit);
        let chunk = &bytes[entry.offset as usize..][..entry.bytes as usize];
        check_crc("chunk", chunk, entry.crc32c).unwrap();
        let units = split_chunk(chunk, frames.len()).unwrap();
        for (f, unit) in units.iter().enumerate() {
            assert_eq!(*unit, vec![(f * 31 + usize::from(tile.x)) as u8; 3 + f]);
        }
    }
    assert_eq!(pack.description().tables[0].bytes, 56);
    assert!(parse_anything(&bytes));
}

#[test]
fn pages_of_the_index_come_in_any_order_and_tell_the_same() {
    let bytes = pack_bytes();
    let (header, whole) = open_file(&bytes).unwrap();
    let description = &bytes[HEADER_BYTES..][..header.description_bytes as usize];
    let part = VideoPack::begin(&header, description).unwrap();
    let pages: Vec<u32> = (0..)
        .take_while(|&n| part.index().page_place(n).is_some())
        .collect();
    assert_eq!(pages.len(), 3);
    let places = pages
        .iter()
        .filter_map(|&page| part.index().page_place(page));
    let end = places.fold(header.index_offset, |at, place| {
        assert_eq!(at, place.start);
        place.end
    });
    assert_eq!(end, header.index_offset + header.index_bytes);
    for page in pages.into_iter().rev() {
        assert!(!part.index().has_page(page));
        let place = part.index().page_place(page).unwrap();
        let page_bytes = &bytes[place.start as usize..place.end as usize];
        assert!(part.index().add_page(page, &page_bytes[1..]).is_err());
        let mut flipped = page_bytes.to_vec();
        flipped[20] ^= 4;
        assert!(part.index().add_page(page, &flipped).is_err());
        assert!(part.index().add_page(page + 1, page_bytes).is_err());
        let of_page = |unit: &UnitId| part.index().numbers().page_of(*unit) == page;
        let unit = part.units().find(of_page).unwrap();
        let on_page = UnitPlace::OnPage { page, range: place };
        assert_eq!(part.index().place(unit), on_page);
        part.index().add_page(page, page_bytes).unwrap();
        assert_eq!(part.index().place(unit), UnitPlace::At(whole.entry(unit)));
    }
    assert_eq!(part, whole);
}

#[test]
fn a_long_level_has_a_page_for_every_1024_units() {
    let long = Description {
        frames: 3000,
        groups: vec![1, 1, 1],
        cut: Cut::Tile(64),
        ..description()
    };
    let numbers = numbers_of(&long).unwrap();
    let header = Header {
        description_bytes: 0,
        description_crc: 0,
        index_offset: 64,
        index_bytes: numbers.index_bytes(),
        file_bytes: 1 << 40,
    };
    let text = serde_json::to_vec(&long).unwrap();
    let header = Header {
        description_crc: crc32c::crc32c(&text),
        ..header
    };
    let pack = VideoPack::begin(&header, &text).unwrap();
    let mut at = header.index_offset;
    for (page, units) in numbers.pages().into_iter().enumerate() {
        let page = page as u32;
        let place = pack.index().page_place(page).unwrap();
        let bytes = 16 + units.len() * 16;
        assert_eq!(place, at..at + bytes as u64);
        at = place.end;
        assert_eq!(pack.index().numbers().page_of(UnitId(units.start)), page);
        assert_eq!(pack.index().numbers().page_of(UnitId(units.end - 1)), page);
    }
    assert_eq!(at, header.index_offset + header.index_bytes);
}

#[test]
fn what_is_usual_is_not_written_and_what_is_not_reads_back() {
    let usual = serde_json::to_string(&description()).unwrap();
    assert!(
        !usual.contains("eyes") && !usual.contains("cube_faces"),
        "{usual}"
    );
    assert!(!usual.contains("pixel_aspect"), "{usual}");
    let both = Description {
        projection: Projection::Cube,
        size: [64, 64],
        eyes: 2,
        cube_faces: 4,
        ..description()
    };
    let wide = Description {
        pixel_aspect: [2, 1],
        eyes: 2,
        ..description()
    };
    let sphere = Description {
        projection: Projection::Equirect,
        size: [64, 32],
        eyes: 2,
        ..description()
    };
    for unusual in [both, wide, sphere] {
        let json = serde_json::to_vec(&unusual).unwrap();
        assert_eq!(Description::parse(&json).unwrap(), unusual);
        let surface = unusual.grid(Screen::default()).surface;
        assert_eq!((surface.eyes, surface.faces() % 2), (2, 0));
    }
}

/// The description of a finished pack of one frame, as its bytes.
fn written(description: Description) -> Vec<u8> {
    let description = Description {
        levels: 1,
        quality: vec![0],
        groups: vec![8],
        frames: 1,
        ..description
    };
    let file = small_pack(description, &[], |_, _| vec![vec![1]]).unwrap();
    let bytes = Header::parse(&file).unwrap().description_bytes;
    file[HEADER_BYTES..][..bytes as usize].to_vec()
}

#[test]
fn a_pack_says_what_a_reader_must_know_to_show_it() {
    let cube = Description {
        projection: Projection::Cube,
        size: [32, 32],
        ..description()
    };
    let equi_angular = cube.clone();
    for (unusual, needs) in [
        (cube.clone(), &[][..]),
        (
            Description {
                eyes: 2,
                cube_faces: 4,
                ..cube
            },
            &["eyes", "cube_faces"],
        ),
        (
            Description {
                mapping: Mapping::EquiAngular,
                ..equi_angular
            },
            &["mapping"],
        ),
        (
            Description {
                pixel_aspect: [4, 3],
                ..description()
            },
            &["pixel_aspect"],
        ),
        (
            Description {
                pixel_aspect: [2, 2],
                ..description()
            },
            &[],
        ),
    ] {
        let bytes = written(unusual);
        let json: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
        let found = json.get("needs").map(|needs| needs.as_array().unwrap());
        let found = found.map(|needs| needs.iter().map(|name| name.as_str().unwrap()).collect());
        let found: Vec<&str> = found.unwrap_or_default();
        assert_eq!(found, needs);
        assert!(Description::parse(&bytes).is_ok());
    }
}

#[test]
fn what_a_later_foveal_writes_is_refused_with_what_to_do() {
    let mut bytes = pack_bytes();
    bytes[8..12].copy_from_slice(&2_u32.to_le_bytes());
    let error = Header::parse(&bytes).unwrap_err().to_string();
    assert!(error.contains("version: found 2, expected 1"), "{error}");
    assert!(error.contains("update foveal"), "{error}");
    bytes[8..12].copy_from_slice(&0_u32.to_le_bytes());
    let error = Header::parse(&bytes).unwrap_err().to_string();
    assert!(!error.contains("update foveal"), "{error}");
    // What is needed is reported even where the rest has another form.
    let later = br#"{"needs": ["eyes", "depth"], "projection": "lightfield"}"#;
    let error = Description::parse(later).unwrap_err().to_string();
    assert!(error.contains("description.needs: found depth"), "{error}");
    assert!(error.contains("update foveal"), "{error}");
    let long = format!(r#"{{"needs": ["{}"]}}"#, "\\u001b".repeat(100_000));
    let error = Description::parse(long.as_bytes()).unwrap_err().to_string();
    assert!(
        error.len() < 1000 && !error.contains('\x1b'),
        "{}",
        error.len()
    );
}

#[test]
fn eyes_faces_pixels_and_fronts_out_of_range_are_refused() {
    for wrong in [
        Description {
            eyes: 0,
            ..description()
        },
        Description {
            eyes: 3,
            ..description()
        },
        Description {
            cube_faces: 5,
            ..description()
        },
        Description {
            pixel_aspect: [0, 1],
            ..description()
        },
        Description {
            pixel_aspect: [1, 17],
            ..description()
        },
        Description {
            pixel_aspect: [u32::MAX, 1],
            ..description()
        },
        Description {
            front_deg: 361.0,
            ..description()
        },
    ] {
        assert!(Description::parse(&serde_json::to_vec(&wrong).unwrap()).is_err());
    }
}

#[test]
fn units_of_the_coarsest_level_come_first() {
    let (_, pack) = open_file(&pack_bytes()).unwrap();
    assert_eq!(
        pack.tile_of(UnitId(0)),
        Tile {
            level: 2,
            face: 0,
            x: 0,
            y: 0
        }
    );
    let levels: Vec<u8> = pack.units().map(|unit| pack.tile_of(unit).level).collect();
    assert!(levels.windows(2).all(|pair| pair[0] >= pair[1]));
}

#[test]
fn every_flipped_byte_outside_the_chunks_is_found() {
    let good = pack_bytes();
    let (header, pack) = open_file(&good).unwrap();
    let table = pack.description().tables[0].clone();
    for place in 0..good.len() {
        let mut bad = good.clone();
        bad[place] ^= 0x40;
        let in_chunk = (header.data_offset()..header.index_offset).contains(&(place as u64));
        let chunk_fails = || {
            pack.units().any(|unit| {
                let e = pack.entry(unit);
                let chunk = &bad[e.offset as usize..][..e.bytes as usize];
                check_crc("chunk", chunk, e.crc32c).is_err()
            })
        };
        let table_fails = || {
            let bytes = &bad[table.offset as usize..][..table.bytes as usize];
            check_crc("table", bytes, table.crc32c).is_err()
        };
        let found = if in_chunk {
            chunk_fails()
        } else {
            open_file(&bad).is_err() || table_fails()
        };
        assert!(found, "byte {place}");
    }
}

#[test]
fn a_truncated_pack_is_refused_without_panicking() {
    let good = pack_bytes();
    for length in 0..good.len() {
        assert!(!parse_anything(&good[..length]));
    }
}

#[test]
fn a_generated_corpus_of_damaged_packs_never_panics() {
    let good = pack_bytes();
    let mut state = 1u64;
    for _ in 0..4000 {
        let mut bad = good.clone();
        for _ in 0..4 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let place = (state >> 33) as usize % bad.len();
            bad[place] = (state >> 24) as u8;
        }
        // Make the outer checksums right again, so that what lies behind them is reached.
        repair_checksums(&mut bad);
        let _ = parse_anything(&bad);
    }
}

fn repair_checksums(bytes: &mut [u8]) {
    let description = HEADER_BYTES..HEADER_BYTES + (u32_at(bytes, 12) as usize).min(4096);
    if let Some(part) = bytes.get(description) {
        let crc = crc32c::crc32c(part);
        bytes[16..20].copy_from_slice(&crc.to_le_bytes());
    }
    let crc = crc32c::crc32c(&bytes[..60]);
    bytes[60..64].copy_from_slice(&crc.to_le_bytes());
}

#[test]
fn a_missing_or_doubled_unit_is_refused_when_building() {
    let description = description();
    let mut builder = begin_pack(&description);
    let tile = Tile {
        level: 2,
        face: 0,
        x: 0,
        y: 0,
    };
    push_tile(&mut builder, tile, 0, &[vec![1]]);
    let error = finish_pack(builder, description.clone(), &[]).unwrap_err();
    assert!(error.to_string().contains("no unit"), "{error}");
    let mut builder = begin_pack(&description);
    push_tile(&mut builder, tile, 0, &[vec![1]]);
    push_tile(&mut builder, tile, 0, &[vec![1]]);
    assert!(
        finish_pack(builder, description, &[])
            .unwrap_err()
            .to_string()
            .contains("twice")
    );
}

#[test]
fn absurd_sizes_are_refused_before_anything_is_allocated() {
    let mut huge = description();
    huge.frames = MAX_FRAMES;
    huge.size = [65_536, 65_536];
    huge.cut = Cut::Tile(64);
    let json = serde_json::to_vec(&huge).unwrap();
    let header = Header {
        description_bytes: json.len() as u32,
        description_crc: crc32c::crc32c(&json),
        index_offset: 64 + json.len() as u64,
        index_bytes: 0,
        file_bytes: 64 + json.len() as u64,
    };
    assert!(VideoPack::parse(&header, &json, &[]).is_err());
}

fn bytes_of_hex(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
    let byte = |pair: &[u8]| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap();
    digits.chunks(2).map(byte).collect()
}

#[test]
fn a_description_without_a_scale_is_on_the_quantiser_scale() {
    let plain = description();
    let json = serde_json::to_string(&plain).unwrap();
    assert!(
        !json.contains("quality_scale") && !json.contains("bit_rates"),
        "{json}"
    );
    assert_eq!(Description::parse(json.as_bytes()), Ok(plain.clone()));
    let rated = Description {
        quality_scale: QualityScale::Ijg,
        bit_rates: vec![9, 8, 7],
        ..plain
    };
    let json = serde_json::to_vec(&rated).unwrap();
    assert_eq!(Description::parse(&json), Ok(rated.clone()));
    let short = Description {
        bit_rates: vec![9, 8],
        ..rated
    };
    assert_eq!(short.check().unwrap_err().field, "description.bit_rates");
}

#[test]
fn a_description_says_how_the_pack_was_made_or_nothing_of_it() {
    let plain = description();
    let json = serde_json::to_string(&plain).unwrap();
    assert!(!json.contains("identity"), "{json}");
    assert_eq!(Description::parse(json.as_bytes()), Ok(plain.clone()));
    let identity = Identity {
        program: "test 1".into(),
        input: "0a".into(),
        settings: "0b".into(),
    };
    let told = Description {
        identity: Some(identity),
        ..plain
    };
    let json = serde_json::to_vec(&told).unwrap();
    assert_eq!(Description::parse(&json), Ok(told));
}

#[test]
fn a_description_tells_what_was_lost_or_nothing_of_it() {
    let plain = description();
    let json = serde_json::to_string(&plain).unwrap();
    assert!(!json.contains("loss"), "{json}");
    let told = |psnr_db, jod| {
        let loss = Some(Loss { psnr_db, jod });
        let told = Description {
            loss,
            ..plain.clone()
        };
        let json = serde_json::to_vec(&told).unwrap();
        Description::parse(&json).map(|read| assert_eq!(read, told))
    };
    for (psnr_db, jod) in [(Some(41.5), 9.73), (None, 10.0), (Some(0.0), -2.5)] {
        assert_eq!(told(psnr_db, jod), Ok(()));
    }
    for (psnr_db, jod) in [(Some(-1.0), 9.0), (Some(151.0), 9.0), (None, 10.5)] {
        let error = told(psnr_db, jod).unwrap_err();
        assert_eq!(error.field, "description.loss");
    }
}

#[test]
fn the_header_is_that_of_the_test_vector() {
    let vector = bytes_of_hex(
        "464f5645414c0d0a 01000000 c00f0000 04030201 00000000
         6810000000000000 2000000000000000 8810000000000000
         000000000000000000000000 7a0f3fa0",
    );
    let header = Header {
        description_bytes: 4032,
        description_crc: 0x0102_0304,
        index_offset: 4200,
        index_bytes: 32,
        file_bytes: 4232,
    };
    assert_eq!(header.write().to_vec(), vector);
    assert_eq!(Header::parse(&vector), Ok(header));
}

#[test]
fn an_index_page_reads_as_the_test_vector_says() {
    let page = bytes_of_hex(
        "00000000 00000000 01000000 8df2e86a
         0010000000000000 07000000 0d0c0b0a",
    );
    let one_unit = Description {
        size: [16, 16],
        levels: 1,
        quality: vec![0],
        groups: vec![8],
        frames: 8,
        ..description()
    };
    let json = serde_json::to_vec(&one_unit).unwrap();
    let header = Header {
        description_bytes: json.len() as u32,
        description_crc: crc32c::crc32c(&json),
        index_offset: 8192,
        index_bytes: 32,
        file_bytes: 8224,
    };
    let pack = VideoPack::parse(&header, &json, &page).unwrap();
    let expected = Entry {
        offset: 4096,
        bytes: 7,
        crc32c: 0x0a0b_0c0d,
    };
    assert_eq!(pack.entry(UnitId(0)), expected);
}
