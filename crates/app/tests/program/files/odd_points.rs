//! Are clouds shown whose colours, intensities or headers cannot be meant as they are?

use super::las::{scan, shown, with};
use super::meshes::{self, prepared};
use super::row::Row;
use crate::support::{Folder, refused};
use std::fmt::Write as _;

/// A sheet of 41 x 41 points as text of PLY, with more numbers behind each.
fn sheet(properties: &str, more: impl Fn(usize) -> String) -> Vec<u8> {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex 1681\nproperty float x\nproperty float y\n\
         property float z\n{properties}end_header\n"
    );
    for k in 0..1681 {
        let [x, y] = [k % 41, k / 41].map(|it| it as f32 / 40.0);
        writeln!(text, "{x} {y} 0 {}", more(k)).unwrap();
    }
    text.into_bytes()
}

const RGB: &str = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
const LIGHT: &str = "property ushort intensity\n";

/// A scan of a sheet in metres whose points have this intensity, and 1 of 50 the most there is.
fn bright_scan(format: u8, intensity: u16, colours: bool) -> Vec<u8> {
    let mut bytes = scan(1681, format, (1, 4), false);
    let word = |bytes: &[u8], at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let begin = word(&bytes, 96) as usize;
    let length = usize::from(u16::from_le_bytes([bytes[105], bytes[106]]));
    for k in 0..1681_usize {
        let record = &mut bytes[begin + k * length..][..length];
        let place = [k % 41, k / 41, 0].map(|it| (it * 25) as i32);
        for (axis, along) in place.into_iter().enumerate() {
            record[4 * axis..4 * axis + 4].copy_from_slice(&along.to_le_bytes());
        }
        let light = if k % 50 == 7 { u16::MAX } else { intensity };
        record[12..14].copy_from_slice(&light.to_le_bytes());
        if colours {
            record[30..36].fill(0);
        }
    }
    bytes
}

#[test]
fn clouds_that_are_all_black_are_grey_and_a_few_bright_points_darken_none() {
    let folder = Folder::new();
    let files = [
        ("bare.ply", sheet(RGB, |_| "0 0 0".to_owned())),
        (
            "lit.ply",
            sheet(&format!("{LIGHT}{RGB}"), |k| {
                format!("{} 0 0 0", 690 + k % 10)
            }),
        ),
        (
            "bright.ply",
            sheet(LIGHT, |k| {
                if k % 50 == 7 { 65_535 } else { 690 + k % 10 }.to_string()
            }),
        ),
        ("lit.las", bright_scan(7, 650, true)),
        ("bright.las", bright_scan(6, 650, false)),
    ];
    let names = files.each_ref().map(|it| it.0);
    for (name, bytes) in &files {
        folder.holding(name, bytes);
    }
    let row = Row::of(&folder, &names);
    assert_eq!(row.colours.len(), names.len(), "{:?}", row.colours);
    for (name, colour) in names.iter().zip(&row.colours) {
        let is_grey = colour.iter().all(|it| it.abs_diff(colour[0]) < 4);
        assert!(
            is_grey && (150..=255).contains(&colour[0]),
            "{name}: {colour:?}"
        );
    }
    assert!(row.colours[0][0] < 190, "{:?}", row.colours);
    assert_eq!(row.mended("black_colours"), 3 * 1681);
    row.assert_remarks(&["\"bare\"", "black", "in one grey"]);
    row.assert_remarks(&["\"lit\"", "black", "by their intensities"]);
    row.assert_remarks(&["\"bright\"", "from 690 to 65535", "699 and more are white"]);
}

#[test]
fn headers_of_scans_that_cannot_be_right_are_read_as_the_points_fit() {
    let folder = Folder::new();
    let plain = || scan(2500, 2, (1, 2), false);
    let word = |number: u32| number.to_le_bytes();
    let real = |number: f64| number.to_le_bytes();
    let packed_bit = |bytes: Vec<u8>| {
        let format = bytes[104] | 0x80;
        with(bytes, 104, &[format])
    };
    let stale: &[&str] = &["stale_counts"];
    let cases: [(&str, Vec<u8>, &[&str]); 11] = [
        ("begin-0.las", with(plain(), 96, &word(0)), stale),
        ("begin-in-header.las", with(plain(), 96, &word(100)), stale),
        ("begin-behind.las", with(plain(), 96, &word(1 << 30)), stale),
        ("no-header.las", with(plain(), 94, &[0, 0]), stale),
        ("long-header.las", with(plain(), 94, &[0xff, 0xff]), stale),
        ("packed.las", packed_bit(plain()), stale),
        ("small-letters.las", with(plain(), 0, b"LASf"), &[]),
        (
            "backward.las",
            with(plain(), 139, &real(-0.001)),
            &["negative_scales"],
        ),
        ("no-scale.las", with(plain(), 139, &real(0.0)), stale),
        (
            "no-offset.las",
            with(plain(), 163, &real(f64::INFINITY)),
            stale,
        ),
        ("nan-scale.las", with(plain(), 131, &real(f64::NAN)), stale),
    ];
    for (name, bytes, names) in cases {
        assert_eq!(shown(&folder, name, &bytes, names), 2500, "{name}");
    }
    let none = with(with(plain(), 131, &real(0.0)), 179, &[0; 48]);
    let file = folder.holding("none.las", &none);
    let arguments = [
        "prepare",
        "scene",
        &file,
        "--out",
        &folder.name("none.foveal"),
    ];
    refused(1, &arguments, &["none.las", "scale", "bounds"]);
}

#[test]
fn the_last_chunk_of_a_scan_whose_points_are_not_counted_is_whole() {
    let folder = Folder::new();
    let uncounted = |count: u32, format: u8| {
        let mut bytes = scan(count, format, (1, 2), true);
        bytes[107..131].fill(0);
        bytes
    };
    for (count, format) in [(2500, 2), (60_001, 3), (7, 0), (1, 1)] {
        let found = shown(
            &folder,
            "last.laz",
            &uncounted(count, format),
            &["stale_counts"],
        );
        assert_eq!(found, u64::from(count), "format {format}");
    }
}

#[test]
fn clouds_of_text_are_read_as_other_programs_write_them() {
    let folder = Folder::new();
    let of = |header: &str, rows: &str| format!("{header}end_header\n{rows}").into_bytes();
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let head =
        |name: &str, count: u32| format!("ply\nformat ascii 1.0\nelement {name} {count}\n{xyz}");
    let flat = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n";
    let cases = [
        (
            "named.ply",
            of(&head("points", 3), "0 0 0\n1 0 0\n0 1 0\n"),
            3,
            "",
        ),
        (
            "capitals.ply",
            of(&head("vertex", 2), "0 0 0\n1 0 0\n").to_ascii_uppercase(),
            2,
            "",
        ),
        (
            "flat.ply",
            of(flat, "0 0\n1 0\n0 1\n"),
            3,
            "coordinates_made",
        ),
        (
            "glued.ply",
            of(&head("vertex", 3), "0.5-0.3 0\n-1.-2.-3.\n1 1 0.5-103\n"),
            3,
            "numbers_without_blanks",
        ),
        (
            "edges.ply",
            of(
                &format!(
                    "{}element edge 2\nproperty int vertex1\nproperty int vertex2\n",
                    head("vertex", 3)
                ),
                "0 0 0\n1 0 0\n0 1 0\n0 1\n1 2\n",
            ),
            3,
            "lines_left_out",
        ),
    ];
    for (name, bytes, points, mend) in cases {
        let names: &[&str] = if mend.is_empty() { &[] } else { &[mend] };
        assert_eq!(shown(&folder, name, &bytes, names), points, "{name}");
    }
    let half: Vec<u8> = [0_u16, 0, 0, 0x3c00, 0, 0, 0, 0x3c00, 0]
        .iter()
        .flat_map(|it| it.to_le_bytes())
        .collect();
    let head = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty half x\n\
                property half y\nproperty half z\nend_header\n";
    let bytes = [head.as_bytes(), &half].concat();
    assert_eq!(shown(&folder, "half.ply", &bytes, &[]), 3);
}

#[test]
fn numbers_in_the_other_order_of_bytes_than_told_are_read_and_told() {
    let folder = Folder::new();
    for (told, stored) in [
        ("little", f32::to_be_bytes as fn(f32) -> [u8; 4]),
        ("big", f32::to_le_bytes),
        ("little", f32::to_le_bytes),
    ] {
        let mut bytes = format!(
            "ply\nformat binary_{told}_endian 1.0\nelement vertex 1681\nproperty float x\n\
             property float y\nproperty float z\nend_header\n"
        )
        .into_bytes();
        for k in 0..1681 {
            let place = [k % 41, k / 41, 0].map(|it| it as f32 / 40.0);
            bytes.extend(place.iter().flat_map(|it| stored(*it)));
        }
        let done = prepared(&folder, "a.ply", &bytes, &[]);
        assert_eq!(done["points"], 1681, "{done}");
        let is_turned = stored(1.0)[0] != 0 && told == "little" || told == "big";
        let times = done["repairs"]["byte_orders_mended"].as_u64().unwrap_or(0);
        assert_eq!(times, u64::from(is_turned), "{done}");
        assert!(meshes::shown(&meshes::picture(&folder)) > 2000);
    }
}
