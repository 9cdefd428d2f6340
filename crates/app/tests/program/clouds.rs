//! Does a laser scan go from its file to the picture that an eye gets?

use crate::support::{Folder, Ran, command, finish, json};
use las::point::Format;
use las::{Builder, Color, Point, Transform, Vector, Writer};
use serde_json::Value;
use std::io::Cursor;

/// Points on a torus ten thousand kilometres from the origin, in millimetres, z up.
fn torus(points: u32) -> Vec<Point> {
    let point = |k: u32| {
        // Steps that fill a square evenly (Roberts 2018, "The unreasonable effectiveness of
        // quasirandom sequences").
        let [u, v] =
            [0.754_877_666, 0.569_840_291].map(|it| std::f64::consts::TAU * it * f64::from(k));
        let ring = 2.0 + 0.7 * v.cos();
        let stripe = if (12.0 * u).sin() > 0.0 { 200 } else { 60 };
        Point {
            x: 1e7 + ring * u.cos(),
            y: -4e6 + ring * u.sin(),
            z: 0.7 * v.sin(),
            intensity: (k % 1000) as u16,
            color: Some(Color::new(
                stripe * 257,
                120 * 257,
                (100 + k as u16 % 9) * 257,
            )),
            ..Point::default()
        }
    };
    (0..points).map(point).collect()
}

fn file(points: Vec<Point>, packs: bool) -> Vec<u8> {
    let mut builder = Builder::from((1, 2));
    builder.point_format = Format::new(2).unwrap();
    builder.point_format.is_compressed = packs;
    let along = |offset| Transform {
        scale: 0.001,
        offset,
    };
    builder.transforms = Vector {
        x: along(1e7),
        y: along(-4e6),
        z: along(0.0),
    };
    let header = builder.into_header().unwrap();
    let mut writer = Writer::new(Cursor::new(Vec::new()), header).unwrap();
    for point in points {
        writer.write_point(point).unwrap();
    }
    writer.close().unwrap();
    writer.into_inner().unwrap().into_inner()
}

fn prepared(folder: &Folder) -> (String, Value) {
    let scan = folder.holding("scan.copc.laz", &file(torus(60_000), true));
    let pack = folder.name("scan.foveal");
    let done = json(&["prepare", "scene", &scan, "--out", &pack]);
    (pack, done)
}

fn simulate(folder: &Folder, pack: &str, more: &[&str]) -> Value {
    let out = folder.name("out");
    let mut arguments = vec!["simulate", pack, "--out", &out];
    arguments.extend([
        "--view",
        "256x160",
        "--renderer",
        "cpu",
        "--pictures",
        "none",
    ]);
    arguments.extend(more);
    json(&arguments)
}

#[test]
fn a_scan_is_prepared_told_of_and_whole() {
    let folder = Folder::new();
    let (pack, done) = prepared(&folder);
    let told = json(&["info", &pack]);
    for told in [&done, &told] {
        assert_eq!(
            (&told["points"], &told["leaf_triangles"]),
            (&60_000.into(), &0.into())
        );
        let sum: u64 = told["bytes_per_level"]
            .as_array()
            .unwrap()
            .iter()
            .map(|it| it.as_u64().unwrap())
            .sum();
        assert_eq!(told["bytes_by_kind"]["points"], sum, "{told}");
        assert_eq!(told["bytes_by_kind"]["mesh"], 0);
        assert!(told["bytes_per_leaf"].as_f64().unwrap() < 9.0, "{told}");
    }
    let verified = json(&["verify", &pack, "--cuts", "2", "--orders", "2"]);
    assert_eq!(
        (&verified["ok"], &verified["odd_edges_max"]),
        (&true.into(), &0.into())
    );
    let mut bytes = std::fs::read(&pack).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    let damaged = folder.holding("damaged.foveal", &bytes);
    assert_eq!(finish(command(&["verify", &damaged])).code, Some(1));
}

#[test]
fn an_eye_gets_a_scan_by_rule_and_within_a_budget() {
    let folder = Folder::new();
    let (pack, _) = prepared(&folder);
    let whole = simulate(&folder, &pack, &["--policy", "full", "--frames", "1"]);
    assert_eq!(whole["error_all"], 0.0, "{whole}");
    let rule = simulate(
        &folder,
        &pack,
        &["--policy", "acuity", "--frames", "2", "--score"],
    );
    assert!(rule["score"]["jod"].as_f64().unwrap() > 8.0, "{rule}");
    assert!(rule["bytes_by_kind"]["points"].as_u64().unwrap() > 0);
    let mut errors: Vec<f64> = Vec::new();
    for frames in ["1", "2", "4", "8", "16"] {
        let run = simulate(
            &folder,
            &pack,
            &[
                "--policy",
                "uniform",
                "--budget",
                "30KB",
                "--interval",
                "200ms",
                "--frames",
                frames,
            ],
        );
        errors.push(run["error_all"].as_f64().unwrap());
    }
    assert!(errors.is_sorted_by(|a, b| a >= b), "{errors:?}");
    assert!(errors[4] < 0.5 * errors[0], "{errors:?}");
}

#[test]
fn scans_that_are_damaged_are_refused_with_place_and_what_to_do() {
    let folder = Folder::new();
    let pack = folder.name("x.foveal");
    for (name, bytes, says) in [
        (
            "cut.las",
            file(torus(100), false)[..240].to_vec(),
            "byte 107: the header counts 100 points",
        ),
        (
            "cut.laz",
            file(torus(100), true)[..300].to_vec(),
            "behind the end",
        ),
        ("none.las", file(Vec::new(), false), "no points"),
        ("else.las", b"else\n".to_vec(), "begins with `LASF`"),
    ] {
        let scan = folder.holding(name, &bytes);
        let Ran { code, stderr, .. } =
            finish(command(&["prepare", "scene", &scan, "--out", &pack]));
        assert_eq!(code, Some(1), "{name}: {stderr}");
        assert!(
            stderr.contains(name) && stderr.contains(says),
            "{name}: {stderr}"
        );
    }
}
