//! Do a few points and triangles far away take no detail from all others?

use crate::scene::torus;
use crate::support::{Folder, Rgb, done, json};
use serde_json::Value;
use std::fmt::Write;

/// A torus of some hundred metres, with tetrahedra of a metre at these places.
fn torus_with(strays: &[[f64; 3]]) -> String {
    let mut text = String::new();
    let mut vertices = 0;
    for line in torus(48, 24).lines() {
        match line.strip_prefix("v ") {
            Some(place) => {
                let far = |it: &str| it.parse::<f64>().unwrap() * 50.0;
                let place: Vec<f64> = place.split(' ').map(far).collect();
                let _ = writeln!(text, "v {} {} {}", place[0], place[1], place[2]);
                vertices += 1;
            }
            None => text += &format!("{line}\n"),
        }
    }
    for [x, y, z] in strays {
        for [a, b, c] in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|it| it.map(f64::from)) {
            let _ = writeln!(text, "v {} {} {}", x + a, y + b, z + c);
        }
        for face in [[1, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4]] {
            let [a, b, c] = face.map(|it| vertices + it);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        vertices += 4;
    }
    text
}

/// What `prepare` says of a file, and its picture.
fn shown(folder: &Folder, name: &str, bytes: &[u8]) -> (Value, Rgb) {
    let source = folder.holding(name, bytes);
    let (pack, out) = (folder.name("a.foveal"), folder.name("out"));
    let told = json(&["prepare", "scene", &source, "--out", &pack, "--force"]);
    done(&[
        "simulate",
        &pack,
        "--out",
        &out,
        "--view",
        "200x200",
        "--frames",
        "1",
        "--policy",
        "full",
        "--renderer",
        "cpu",
    ]);
    (told, Rgb::read(&format!("{out}/frame_00000.png")))
}

#[test]
fn triangles_far_away_take_no_detail_from_a_mesh_and_open_no_crack() {
    let folder = Folder::new();
    let plain = shown(&folder, "plain.obj", torus_with(&[]).as_bytes());
    let far = [[0.0, 30e3, 7.0], [-300e3, 0.0, 0.0], [0.0, 0.0, -5.4e6]];
    for strays in [&far[..1], &far[1..2], &far[2..], &far] {
        let (told, picture) = shown(&folder, "strays.obj", torus_with(strays).as_bytes());
        let remarks = told["remarks"].as_array().unwrap();
        assert_eq!(remarks.len(), strays.len(), "{told}");
        assert!(
            remarks[0]
                .as_str()
                .unwrap()
                .contains("4 triangles of \"strays\" lie far")
        );
        assert_eq!(told["repairs"]["outlier_triangles"], 4 * strays.len());
        assert_eq!(told["leaf_triangles"], 2304 + 4 * strays.len());
        assert_eq!(
            (&told["centre"], &told["radius"]),
            (&plain.0["centre"], &plain.0["radius"])
        );
        assert_eq!(picture.difference(&plain.1), 0);
        let pack = folder.name("a.foveal");
        let tried = json(&["verify", &pack, "--cuts", "20", "--orders", "100"]);
        assert_eq!(
            (&tried["ok"], &tried["odd_edges_max"]),
            (&true.into(), &0.into())
        );
    }
}

/// A bowl of points, 1 m wide, with others before them.
fn points_with(others: &[[f64; 3]]) -> String {
    let along = || (0..60).map(|it| f64::from(it) / 59.0);
    let bowl = along().flat_map(|x| along().map(move |y| [x, y, (x - 0.5).powi(2)]));
    let all: Vec<[f64; 3]> = others.iter().copied().chain(bowl).collect();
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
         end_header\n",
        all.len()
    );
    for [x, y, z] in all {
        let _ = writeln!(
            text,
            "{x} {y} {z} {} {} 90",
            (x.abs() * 200.0) as u8,
            (y.abs() * 200.0) as u8
        );
    }
    text
}

#[test]
fn points_without_an_echo_take_no_detail_from_a_cloud() {
    let folder = Folder::new();
    let plain = shown(&folder, "plain.ply", points_with(&[]).as_bytes());
    let none = [-9999.0; 3];
    let slanted: Vec<[f64; 3]> = (0..900)
        .map(|x| [f64::from(x) / 900.0, 0.4, -9999.0])
        .collect();
    for others in [
        &[none][..],
        &[none; 3000],
        &[[0.5, 0.5, 1e10]],
        &slanted,
        &[none, [1e10; 3]],
    ] {
        let (told, picture) = shown(&folder, "none.ply", points_with(others).as_bytes());
        assert_eq!(told["points"], 3600, "{told}");
        assert_eq!(told["repairs"]["outlier_points_left_out"], others.len());
        let remark = told["remarks"][0].as_str().unwrap();
        assert!(
            remark.contains("far from its others") && remark.contains("left out"),
            "{remark}"
        );
        assert_eq!(picture.difference(&plain.1), 0, "{} others", others.len());
    }
}
