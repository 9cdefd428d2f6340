//! Can the bytes of a scene, of one of its units or of a route make their readers panic?

use crate::image_pages;
use crate::mesh_units;
use crate::scene_packs::{ATTRIBUTES, pack_of, repair_checksums, units};
use foveal_core::content::images::payload::{PageCodec, page_bytes};
use foveal_core::content::images::shape::PagePlace;
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::{Attributes, MeshUnit};
use foveal_core::content::scene::description::SceneDescription;
use foveal_core::content::scene::pack::parse_anything;
use foveal_core::content::scene::unit_table::{UnitRow, read_units, write_units};
use foveal_core::gaze::read::route;
use foveal_core::pack::UnitNumbers;
use foveal_core::pack::paged_table::{PageDirectory, write_pages};
use foveal_core::pack::unit::UnitId;
use foveal_core::view::random::Random;

// The vectors of docs/formats/pack.md.
const TABLE: &str = "
    02000000 7a96fd7c
    00000000 27000000 c6a8ed24
    01000000 29000000 98d6afde
    00 00 0000 0000003f 0000003f 00000000 0000803f 0000807f
    000000000000000000000000 02 04 00
    00 01 0000 0000003f 0000003f 00000000 0000803f 0000003d
    0102030405060708090a0b0c 04 05 01 01 00
";
const ROOT: &str = "
    21 01 0000 0400 04 02 10
    0000000000000000000000000000000c
    00aa0000000000009970d00100c04107000000
    a1aa00000000000000000000000000000000000000007f000000
";
const FINER: &str = "
    21 01 0400 0100 05 04 15
    000104020300000000000000000000000000003f01
    0055d207d00750000000
    a1aa00000000000000000000000000000000000000007f000000
";

fn bytes_of_hex(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
    let byte = |pair: &[u8]| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap();
    digits.chunks(2).map(byte).collect()
}

/// One to four bytes of these become any others.
fn damaged(good: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bad = good.to_vec();
    for _ in 0..1 + (random.unit() * 4.0) as usize {
        let place = (random.unit() * bad.len() as f64) as usize;
        bad[place] = (random.unit() * 256.0) as u8;
    }
    bad
}

#[test]
fn a_scene_of_a_long_description_has_its_objects_in_a_table_and_no_byte_of_it_panics() {
    let pack = pack_of(|about| about.objects[0].name = "part ".repeat(10_000));
    let head = String::from_utf8_lossy(&pack[64..4096]).into_owned();
    assert!(head.contains(r#""needs":["scene","objects"]"#), "{head}");
    assert!(parse_anything(&pack));
    let index = u64::from_le_bytes(pack[24..32].try_into().unwrap()) as usize;
    // Beyond the long name, which is for people.
    let tables = index..index + 100;
    for place in tables.chain(pack.len() - 400..pack.len()) {
        let mut bad = pack.clone();
        bad[place] ^= 0x10;
        let _ = parse_anything(&bad);
    }
}

#[test]
fn a_table_of_units_is_that_of_the_test_vector() {
    let vector = bytes_of_hex(TABLE);
    let numbers = UnitNumbers::in_pages_of(64, &[1, 1]).unwrap();
    let rows: Vec<UnitRow> = units().map(|(row, _)| row).to_vec();
    assert_eq!(write_units(&rows, 64, &numbers), vector);
    let directory = PageDirectory::parse(&vector, 2, vector.len() as u64).unwrap();
    let read = (0..directory.len()).flat_map(|page| {
        let place = directory.place(page);
        let bytes = &vector[place.start as usize..place.end as usize];
        read_units(&directory, page, bytes).unwrap()
    });
    assert_eq!(read.collect::<Vec<_>>(), rows);
}

#[test]
fn units_of_a_mesh_are_those_of_the_test_vectors() {
    for ((_, says), vector) in units().into_iter().zip([ROOT, FINER].map(bytes_of_hex)) {
        assert_eq!(says.write(ATTRIBUTES), Ok(vector.clone()));
        assert_eq!(
            MeshUnit::parse(&vector, ATTRIBUTES, &says.replaces),
            Ok(says)
        );
    }
}

#[test]
fn the_finer_unit_of_the_vectors_takes_the_place_of_the_root() {
    let [(_, root), (row, finer)] = units();
    let mut cut = MeshCut::default();
    assert!(cut.insert(UnitId(1), &row.needs, &finer).is_err());
    cut.insert(UnitId(0), &[], &root).unwrap();
    cut.insert(UnitId(1), &row.needs, &finer).unwrap();
    let drawn: Vec<UnitId> = cut.drawn().map(|(unit, ..)| unit).collect();
    assert_eq!(drawn, [UnitId(1)]);
}

#[test]
fn a_scene_that_needs_more_than_this_program_knows_is_refused() {
    let json = |change: fn(&mut SceneDescription)| {
        let pack = pack_of(|_| ());
        let end = pack[64..].iter().position(|byte| *byte == b' ').unwrap();
        let mut about = SceneDescription::parse(&pack[64..64 + end]).unwrap();
        change(&mut about);
        let json = serde_json::to_vec(&about).unwrap();
        SceneDescription::parse(&json).map_err(|error| error.field)
    };
    assert!(json(|_| ()).is_ok());
    let field = |field: &str| Err(field.to_owned());
    type Change = fn(&mut SceneDescription);
    let refused: [(Change, &str); 6] = [
        (
            |it| it.needs.push("textures".to_owned()),
            "description.needs",
        ),
        (|it| it.kind = "points".to_owned(), "description.kind"),
        (|it| it.units = vec![1, 0], "units"),
        (|it| it.page = 0, "page"),
        (|it| it.look.background[1] = 1.5, "look.background"),
        (|it| it.look.light = [0.0; 3], "look.light"),
    ];
    for (change, expected) in refused {
        assert_eq!(json(change), field(expected));
    }
}

#[test]
fn a_truncated_scene_is_refused() {
    let good = pack_of(|_| ());
    assert!(parse_anything(&good));
    for length in (0..good.len()).step_by(7) {
        assert!(!parse_anything(&good[..length]), "{length}");
    }
}

#[test]
fn a_generated_corpus_of_damaged_scenes_never_panics() {
    let good = pack_of(|_| ());
    let mut repaired = good.clone();
    repair_checksums(&mut repaired);
    assert_eq!(repaired, good, "a good pack is right as it is");
    let mut random = Random::new(5);
    let mut accepted = 0;
    // Most of the pack is room in its description: damage what is written.
    let chunks = 64 + u32::from_le_bytes(good[12..16].try_into().unwrap()) as usize;
    let room = good[..chunks].iter().rev();
    let end = chunks - room.take_while(|byte| **byte == b' ').count();
    for _ in 0..4000 {
        let written = [
            damaged(&good[..end], &mut random),
            good[end..chunks].to_vec(),
        ];
        let bad = [written.concat(), damaged(&good[chunks..], &mut random)];
        for mut bad in [bad.concat(), [&good[..chunks], &bad[1]].concat()] {
            let _ = parse_anything(&bad);
            repair_checksums(&mut bad);
            accepted += usize::from(parse_anything(&bad));
        }
    }
    assert!(
        accepted > 500,
        "only {accepted} of 8000 were read to the end"
    );
}

/// A page of the first texture, as JPEG and as PNG.
fn pages() -> [Vec<u8>; 2] {
    let [columns, rows] = image_pages::textures()[0].size.map(|it| it as u16 + 2);
    let texels: Vec<u8> = (0..3 * columns * rows).map(|it| (it * 7) as u8).collect();
    let (mut jpeg, mut png) = (Vec::new(), Vec::new());
    let encoder = jpeg_encoder::Encoder::new(&mut jpeg, 80);
    let kind = jpeg_encoder::ColorType::Rgb;
    encoder.encode(&texels, columns, rows, kind).unwrap();
    let mut encoder = png::Encoder::new(&mut png, columns.into(), rows.into());
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&texels).unwrap();
    writer.finish().unwrap();
    let page = PagePlace::default();
    [(PageCodec::Jpeg, jpeg), (PageCodec::Png, png)]
        .map(|(codec, file)| page_bytes(0, page, codec, &file))
}

#[test]
fn a_generated_corpus_of_damaged_pages_never_panics() {
    let mut random = Random::new(8);
    for good in pages() {
        assert!(image_pages::parse_anything(&good));
        for length in 0..good.len() {
            image_pages::parse_anything(&good[..length]);
        }
        for _ in 0..4000 {
            image_pages::parse_anything(&damaged(&good, &mut random));
        }
        let mut other = good.clone();
        other[2] = 1;
        assert!(
            !image_pages::parse_anything(&other),
            "the size of another texture's page"
        );
    }
}

#[test]
fn a_generated_corpus_of_damaged_units_never_panics() {
    let mut random = Random::new(6);
    for (_, says) in units() {
        for colours in [false, true] {
            let attributes = Attributes {
                normals: true,
                colours,
                textured: colours,
            };
            let good = says.write(attributes).unwrap();
            for length in 0..good.len() {
                assert!(MeshUnit::parse(&good[..length], attributes, &[]).is_err());
            }
            for _ in 0..2000 {
                mesh_units::parse_anything(&damaged(&good, &mut random));
            }
        }
    }
}

#[test]
fn any_bytes_as_rows_of_a_table_are_refused_or_read_back_as_they_are() {
    let mut random = Random::new(8);
    let rows: Vec<UnitRow> = units().map(|(row, _)| row).to_vec();
    let numbers = UnitNumbers::in_pages_of(64, &[2]).unwrap();
    let read = |page: &[u8]| {
        let table = write_pages(&[page.to_vec(), Vec::new()], 64, &[]);
        let directory = PageDirectory::parse(&table, 2, table.len() as u64).unwrap();
        read_units(&directory, 0, page)
    };
    let written = |rows: &[UnitRow]| write_units(rows, 64, &numbers)[20..].to_vec();
    let good = written(&rows);
    assert_eq!(read(&good), Ok(rows));
    let mut accepted = 0;
    for _ in 0..4000 {
        if let Ok(rows) = read(&damaged(&good, &mut random)) {
            accepted += 1;
            assert_eq!(read(&written(&rows)), Ok(rows));
        }
    }
    assert!(accepted > 100, "only {accepted} of 4000 were rows");
}

#[test]
fn a_generated_corpus_of_damaged_routes_never_panics() {
    let good = b"t_s,x,y,z,yaw_deg,pitch_deg\n0,0,1.6,3,0,0\n4,0,1.6,1,0,-20\n";
    let mut random = Random::new(7);
    assert!(route::parse_anything(good));
    let mut refused = 0;
    for _ in 0..5000 {
        refused += usize::from(!route::parse_anything(&damaged(good, &mut random)));
    }
    assert!(refused > 1000, "only {refused} of 5000 were refused");
}
