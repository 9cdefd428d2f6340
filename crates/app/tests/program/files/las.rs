//! Are scans shown whose headers and files do not fit to each other?

use crate::support::{Folder, json, refused};
use las::point::Format;
use las::{Builder, Color, Point, Transform, Vector, Writer};
use std::io::Cursor;

/// So many points on a sheet of 10 m.
pub(super) fn scan(count: u32, format: u8, version: (u8, u8), packs: bool) -> Vec<u8> {
    let mut builder = Builder::from(version);
    builder.point_format = Format::new(format).unwrap();
    builder.point_format.is_compressed = packs;
    let along = Transform {
        scale: 0.001,
        offset: 0.0,
    };
    builder.transforms = Vector {
        x: along,
        y: along,
        z: along,
    };
    let has_colour = builder.point_format.has_color;
    let has_time = builder.point_format.has_gps_time;
    let header = builder.into_header().unwrap();
    let mut writer = Writer::new(Cursor::new(Vec::new()), header).unwrap();
    for k in 0..count {
        let code = (k % 200) as u16 * 257;
        let point = Point {
            x: f64::from(k % 100) * 0.1,
            y: f64::from(k / 100) * 0.1,
            z: f64::from(k % 7) * 0.01,
            color: has_colour.then_some(Color::new(code, 20_000, 50_000 - code / 2)),
            gps_time: has_time.then_some(f64::from(k)),
            ..Point::default()
        };
        writer.write_point(point).unwrap();
    }
    writer.close().unwrap();
    writer.into_inner().unwrap().into_inner()
}

pub(super) fn with(mut bytes: Vec<u8>, at: usize, number: &[u8]) -> Vec<u8> {
    bytes[at..at + number.len()].copy_from_slice(number);
    bytes
}

/// How many points are shown where `names` of repairs must be reported.
pub(super) fn shown(folder: &Folder, name: &str, bytes: &[u8], names: &[&str]) -> u64 {
    let pack = folder.name("scan.foveal");
    let file = folder.holding(name, bytes);
    let done = json(&["prepare", "scene", &file, "--out", &pack, "--force"]);
    let told = json(&["info", &pack]);
    assert_eq!(done["repairs"], told["repairs"], "{name}");
    let repairs = told["repairs"].as_object().unwrap();
    let mut known: Vec<&str> = repairs.keys().map(String::as_str).collect();
    known.sort_unstable();
    assert_eq!(known, names, "{name}: {told}");
    assert_eq!(
        told["remarks"].as_array().unwrap().is_empty(),
        names.is_empty(),
        "{name}: {told}"
    );
    told["points"].as_u64().unwrap()
}

#[test]
fn bytes_behind_the_points_and_stale_counts_cost_no_point() {
    let folder = Folder::new();
    let plain = || scan(2500, 2, (1, 2), false);
    let of_4 = || scan(2500, 7, (1, 4), false);
    let word = |number: u32| number.to_le_bytes();
    let cases: [(&str, Vec<u8>, &[&str]); 8] = [
        ("whole.las", plain(), &[]),
        (
            "behind.las",
            [plain(), vec![0; 777]].concat(),
            &["bytes_behind_points"],
        ),
        (
            "records-behind.las",
            [plain(), vec![3; 26 * 40]].concat(),
            &["bytes_behind_points"],
        ),
        (
            "echoes.las",
            with(plain(), 111, &word(90_000)),
            &["stale_counts"],
        ),
        (
            "echoes-of-4.las",
            with(of_4(), 255, &90_000_u64.to_le_bytes()),
            &["stale_counts"],
        ),
        (
            "uncounted.las",
            with(plain(), 107, &word(0)),
            &["stale_counts"],
        ),
        (
            "old-count.las",
            with(of_4(), 107, &word(17)),
            &["stale_counts"],
        ),
        (
            "later-records.las",
            with(of_4(), 243, &word(3)),
            &["stale_counts"],
        ),
    ];
    for (name, bytes, names) in cases {
        assert_eq!(shown(&folder, name, &bytes, names), 2500, "{name}");
    }
}

#[test]
fn a_scan_that_was_cut_short_shows_the_points_that_are_there() {
    let folder = Folder::new();
    let plain = scan(2500, 3, (1, 2), false);
    let cut = &plain[..plain.len() - 100 * 34 - 5];
    let found = shown(&folder, "cut.las", cut, &["missing_points"]);
    assert_eq!(found, 2399);
    for (format, version) in [(3, (1, 2)), (7, (1, 4))] {
        let packed = scan(120_000, format, version, true);
        let cut = &packed[..packed.len() / 2];
        let names = ["missing_points", "stale_counts"];
        let found = shown(&folder, "cut.laz", cut, &names);
        assert!((50_000..100_000).contains(&found), "{found}");
    }
    let header = &plain[..300];
    let file = folder.holding("header.las", &header[..250]);
    let out = folder.name("none.foveal");
    refused(
        1,
        &["prepare", "scene", &file, "--out", &out],
        &["header.las", "record"],
    );
}
