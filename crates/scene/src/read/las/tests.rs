//! Are LAS and LAZ files read to the last bit, and damaged ones refused?

use super::super::mangle::cut_and_flip;
use super::super::{ReadOptions, SceneFormat};
use super::*;
use las::point::Format;
use las::{Builder, Color, Point, Transform, Vector, Writer};
use std::io::Cursor;

/// Points that are far from the origin, in steps of a millimetre.
fn points(count: i32) -> Vec<Point> {
    let point = |k: i32| Point {
        x: 1e7 + f64::from(k) * 0.001,
        y: -5e6 + f64::from(k * 7 % 1000) * 0.001,
        z: 100.0 + f64::from(k % 13) * 0.001,
        intensity: (k % 2000 * 31) as u16,
        classification: las::point::Classification::new((k % 5 + 2) as u8).unwrap(),
        color: Some(Color::new((k % 256) as u16 * 257, 5, 65_535 - k as u16)),
        gps_time: Some(f64::from(k)),
        ..Point::default()
    };
    (0..count).map(point).collect()
}

/// A file of these points.
fn file(points: &[Point], format: u8, version: (u8, u8), packs: bool) -> Vec<u8> {
    let mut builder = Builder::from(version);
    builder.point_format = Format::new(format).unwrap();
    builder.point_format.is_compressed = packs;
    let along = |offset| Transform {
        scale: 0.001,
        offset,
    };
    builder.transforms = Vector {
        x: along(1e7),
        y: along(-5e6),
        z: along(0.0),
    };
    let format = builder.point_format;
    let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    for point in points {
        let mut point = point.clone();
        point.color = point.color.filter(|_| format.has_color);
        point.gps_time = point.gps_time.filter(|_| format.has_gps_time);
        writer.write_point(point).unwrap();
    }
    writer.close().unwrap();
    writer.into_inner().unwrap().into_inner()
}

#[test]
fn every_version_and_format_tells_the_same_whole_numbers() {
    let points = points(700);
    let kinds = [
        (0, (1, 0)),
        (1, (1, 1)),
        (2, (1, 2)),
        (3, (1, 3)),
        (6, (1, 4)),
        (7, (1, 4)),
    ];
    for (format, version) in kinds {
        for packs in [false, true] {
            let what = format!("format {format} of {version:?}, packed: {packs}");
            let scene = read(&file(&points, format, version, packs), "a").unwrap();
            let cloud = &scene.clouds[0];
            assert_eq!(cloud.places.len(), 700, "{what}");
            assert_eq!((cloud.scale, cloud.offset), ([0.001; 3], [1e7, -5e6, 0.0]));
            for (k, point) in points.iter().enumerate() {
                let number = k as i32;
                let place = [number, number * 7 % 1000, 100_000 + number % 13];
                assert_eq!(cloud.places[k], place, "{what}");
                assert_eq!(cloud.intensities[k], point.intensity, "{what}");
                assert_eq!(cloud.classes[k], u8::from(point.classification), "{what}");
                let Some(colour) = point.color.filter(|_| !cloud.colours.is_empty()) else {
                    continue;
                };
                assert_eq!(cloud.colours[k], [colour.red, colour.green, colour.blue]);
            }
            let has_colours = matches!(format, 2 | 3 | 7);
            assert_eq!(cloud.colours.is_empty(), !has_colours, "{what}");
        }
    }
}

#[test]
fn packed_points_of_several_chunks_all_come() {
    let points = points(60_000);
    let scene = read(&file(&points, 2, (1, 2), true), "a").unwrap();
    assert_eq!(scene.clouds[0].places[59_999][0], 59_999);
    let scene = read(&file(&points, 7, (1, 4), true), "a").unwrap();
    assert_eq!(scene.clouds[0].places[59_999][0], 59_999);
}

#[test]
fn what_a_machine_scans_of_a_plain_is_read_though_it_packs_beyond_a_hundred_to_one() {
    let step = |k: i32| Point {
        x: 1e7 + f64::from(k) * 0.001,
        y: -5e6,
        z: 100.0,
        gps_time: Some(1.0),
        ..Point::default()
    };
    let plain: Vec<Point> = (0..300_000).map(step).collect();
    for (format, version, record) in [(0, (1, 2), 20), (6, (1, 4), 30)] {
        let bytes = file(&plain, format, version, true);
        let ratio = plain.len() * record / bytes.len();
        assert!(ratio > 100, "{ratio}");
        let scene = read(&bytes, "a").unwrap();
        assert_eq!(scene.clouds[0].places[299_999][0], 299_999);
    }
}

fn refusal(bytes: &[u8]) -> String {
    let fault = read(bytes, "a").unwrap_err();
    fault.in_file(std::path::Path::new("a.las")).to_string()
}

#[test]
fn wrong_counts_are_refused_with_place_and_what_to_do() {
    for packs in [false, true] {
        for count in [0_u32, 5, 700_000, u32::MAX] {
            let mut bytes = file(&points(700), 2, (1, 2), packs);
            bytes[107..111].copy_from_slice(&count.to_le_bytes());
            let expected = match count {
                0 => "the file has no points",
                // Unless it was cut off.
                700_000.. if !packs => continue,
                _ => "a.las: byte 107: the header counts",
            };
            let said = refusal(&bytes);
            assert!(said.contains(expected), "{said}");
            assert!(count == 0 || said.contains("lasinfo -repair"), "{said}");
        }
    }
    let cut = file(&points(700), 2, (1, 2), false);
    let cut = read(&cut[..cut.len() - 25], "a").unwrap();
    assert_eq!(cut.clouds[0].places.len(), 699);
    assert_eq!(cut.repairs["rows_missing"], 1);
    assert!(cut.remarks[0].contains("is point 699"), "{:?}", cut.remarks);
}

#[test]
fn packed_files_that_were_cut_off_show_the_points_that_are_there() {
    let points = points(120_000);
    for (format, version) in [(2, (1, 2)), (7, (1, 4))] {
        let whole = file(&points, format, version, true);
        for part in [50, 70, 95] {
            let cut = &whole[..whole.len() * part / 100];
            let scene = read(cut, "a").unwrap();
            let places = &scene.clouds[0].places;
            let expected = |k: usize| {
                let number = k as i32;
                [number, number * 7 % 1000, 100_000 + number % 13]
            };
            let right = (0..places.len()).all(|k| places[k] == expected(k));
            assert!(
                right && places.len() >= 100 * part,
                "{} of {part} %",
                places.len()
            );
            let missing = 120_000 - places.len() as u64;
            assert_eq!(scene.repairs["rows_missing"], missing, "{format}, {part} %");
        }
    }
}

#[test]
fn wrong_counts_of_records_and_echoes_are_refused() {
    let refused = |at: usize, count: u32, version: (u8, u8), expected: &str| {
        let mut bytes = file(&points(700), 2, version, false);
        bytes[at..at + 4].copy_from_slice(&count.to_le_bytes());
        let said = refusal(&bytes);
        assert!(
            said.contains(expected) && said.contains("lasinfo -repair"),
            "{said}"
        );
    };
    refused(
        100,
        7,
        (1, 2),
        "byte 100: the header counts 7 records before the points, but 0 fit",
    );
    refused(
        111,
        701,
        (1, 2),
        "byte 111: the header counts 701 echoes of pulses, but 700 points",
    );
    refused(
        255,
        701,
        (1, 4),
        "byte 255: the header counts 701 echoes of pulses, but 700 points",
    );
    refused(
        243,
        2,
        (1, 4),
        "byte 243: the header counts 2 records behind the points, but 0 fit",
    );
}

#[test]
fn damaged_files_are_refused_or_read_and_never_panic() {
    for (format, version, packs) in [
        (2, (1, 2), false),
        (2, (1, 2), true),
        (7, (1, 4), false),
        (7, (1, 4), true),
    ] {
        cut_and_flip(SceneFormat::Las, &file(&points(9), format, version, packs));
    }
}

#[test]
fn z_is_up_in_a_cloud_and_where_it_is_said_so() {
    let path = std::env::temp_dir().join(format!("foveal-las-{}.LAZ", std::process::id()));
    std::fs::write(&path, file(&points(3), 2, (1, 2), true)).unwrap();
    let scene = super::super::read(&[&path], &ReadOptions::default()).unwrap();
    std::fs::remove_file(&path).unwrap();
    let cloud = &scene.clouds[0];
    let at = cloud.placements[0].transform_point3(glam::DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(at, glam::DVec3::new(1.0, 3.0, -2.0));
    assert!(cloud.name.starts_with("foveal-las"));
}
