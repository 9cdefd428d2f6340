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

/// What is left of a file that was changed: points, remarks, and repairs by name.
fn mended(bytes: &[u8]) -> (usize, String, Vec<(String, u64)>) {
    let scene = read(bytes, "a").unwrap();
    let told = scene.remarks.join("\n");
    (
        scene.clouds[0].places.len(),
        told,
        scene.repairs.into_iter().collect(),
    )
}

fn counts(told: &[(&str, u64)]) -> Vec<(String, u64)> {
    let told = told.iter();
    told.map(|(name, times)| ((*name).to_owned(), *times))
        .collect()
}

/// The file with a number of 32 bits changed.
fn with_word(mut bytes: Vec<u8>, at: usize, word: u32) -> Vec<u8> {
    bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
    bytes
}

#[test]
fn a_wrong_count_of_points_costs_only_what_is_not_there() {
    let plain = || file(&points(700), 2, (1, 2), false);
    let (found, told, repairs) = mended(&with_word(plain(), 107, 5));
    assert_eq!(
        (found, repairs),
        (5, counts(&[("bytes_behind_points", 695 * 26)]))
    );
    assert!(told.contains("18070 bytes behind the 5 points"), "{told}");
    for count in [700_000, u32::MAX] {
        let (found, told, repairs) = mended(&with_word(plain(), 107, count));
        let missing = u64::from(count) - 700;
        // The counts of echoes are no wrong ones.
        assert_eq!(
            (found, repairs),
            (700, counts(&[("missing_points", missing)]))
        );
        assert!(
            told.contains(&format!("{missing} of {count} points")),
            "{told}"
        );
    }
    let (found, told, _) = mended(&with_word(plain(), 107, 0));
    assert_eq!(found, 700);
    assert!(told.contains("counts no points; the 700"), "{told}");
    let whole = plain();
    let (found, _, repairs) = mended(&whole[..whole.len() - 27]);
    assert_eq!((found, repairs), (698, counts(&[("missing_points", 2)])));
    let longer = [whole, vec![7; 1000]].concat();
    let (found, _, repairs) = mended(&longer);
    assert_eq!(
        (found, repairs),
        (700, counts(&[("bytes_behind_points", 1000)]))
    );
}

#[test]
fn packed_points_that_are_there_come_whatever_is_counted() {
    let chunked = || file(&points(700), 2, (1, 2), true);
    let (found, told, repairs) = mended(&with_word(chunked(), 107, 5));
    assert_eq!((found, repairs.len()), (5, 1), "{told}");
    // Echoes are counted in addition to points.
    let uncounted = with_word(with_word(chunked(), 107, 0), 111, 700);
    let (found, told, repairs) = mended(&uncounted);
    assert_eq!((found, repairs), (700, counts(&[("stale_counts", 1)])));
    assert!(told.contains("the 700 whose echoes it counts"), "{told}");
    let without = (111..131).step_by(4);
    let without = without.fold(uncounted, |bytes, at| with_word(bytes, at, 0));
    let (found, told, _) = mended(&without);
    assert_eq!(found, 700);
    assert!(!told.contains("missing"), "{told}");
    let all = read(&chunked(), "a").unwrap().clouds.remove(0).places;
    for count in [60_000, 700_000, u32::MAX] {
        // Packing the last chunk again shows how many points it has.
        let scene = read(&with_word(chunked(), 107, count), "a").unwrap();
        let found = &scene.clouds[0].places;
        assert_eq!(*found, all, "{count}");
        let missing = scene.repairs["missing_points"];
        assert_eq!(missing, u64::from(count) - found.len() as u64);
    }
    // Chunks of layers say themselves how many points they have.
    let mut layered = file(&points(700), 7, (1, 4), true);
    layered[247..255].copy_from_slice(&9_u64.to_le_bytes());
    let (found, told, _) = mended(&layered);
    assert!(found == 700 && told.contains("counts 9 points"), "{told}");
}

#[test]
fn a_length_of_records_that_does_not_fit_their_format_is_told_by_the_bytes() {
    let with_length = |mut bytes: Vec<u8>, length: u16| {
        bytes[105..107].copy_from_slice(&length.to_le_bytes());
        bytes
    };
    let coloured = with_length(file(&points(700), 2, (1, 2), false), 20);
    let (found, told, repairs) = mended(&coloured);
    assert_eq!((found, repairs), (700, counts(&[("stale_counts", 1)])));
    assert!(told.contains("26 are read"), "{told}");
    assert!(!read(&coloured, "a").unwrap().clouds[0].colours.is_empty());
    let mut bare = file(&points(700), 0, (1, 2), false);
    bare[104] = 2;
    let (found, told, _) = mended(&bare);
    assert!(
        found == 700 && told.contains("of a format of 20 bytes"),
        "{told}"
    );
}

#[test]
fn a_packed_file_that_was_cut_short_keeps_the_points_before() {
    let points = points(120_000);
    for (format, version) in [(2, (1, 2)), (7, (1, 4))] {
        let whole = file(&points, format, version, true);
        for cut in [1, 30, whole.len() / 3] {
            let scene = read(&whole[..whole.len() - cut], "a").unwrap();
            let places = &scene.clouds[0].places;
            let least = if cut < 100 { 100_000 } else { 50_000 };
            assert!(places.len() >= least, "{format}: {cut}: {}", places.len());
            for (k, place) in places.iter().enumerate() {
                assert_eq!(place[0], k as i32, "{format}: {cut}");
            }
            let missing = scene.repairs.get("missing_points").copied().unwrap_or(0);
            assert_eq!(missing as usize + places.len(), points.len());
            assert!(scene.remarks[0].contains("table of chunks is missing"));
        }
        // A damaged chunk costs its own points.
        let mut damaged = whole.clone();
        let middle = whole.len() / 2;
        damaged[middle..middle + 40].fill(0xff);
        let _ = read(&damaged, "a");
    }
}

#[test]
fn stale_counts_of_records_and_echoes_are_told() {
    let told = |at: usize, count: u32, version: (u8, u8), expected: &str| {
        let bytes = file(
            &points(700),
            if version.1 == 4 { 6 } else { 2 },
            version,
            false,
        );
        let (found, told, repairs) = mended(&with_word(bytes, at, count));
        assert_eq!((found, repairs), (700, counts(&[("stale_counts", 1)])));
        assert!(told.contains(expected), "{told}");
    };
    told(
        100,
        7,
        (1, 2),
        "counts 7 records before the points, of which 0 fit",
    );
    told(
        111,
        701,
        (1, 2),
        "counts 701 echoes of pulses, but 700 points",
    );
    told(
        255,
        701,
        (1, 4),
        "counts 701 echoes of pulses, but 700 points",
    );
    told(
        243,
        2,
        (1, 4),
        "counts 2 records behind the points, of which 0 fit",
    );
    told(
        107,
        40,
        (1, 4),
        "counts 40 points, and at byte 247 700: 700 are read",
    );
    // A header that is shorter than that of its version.
    let mut short = file(&points(9), 2, (1, 2), false);
    short[25] = 4;
    let (found, text, _) = mended(&short);
    assert!(found == 9 && text.contains("as one of LAS 1.2"), "{text}");
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
