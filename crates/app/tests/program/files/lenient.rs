//! Does what other readers accept silently come into a pack, look right, and get reported?

use super::row::{Row, png_of};
use crate::support::{Folder, Rgb, done, json};

const RED: [u8; 3] = [200, 20, 20];

/// A square as OBJ with something before its face.
fn obj(before: &str, face: &str) -> String {
    format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n{before}\n{face}\n")
}

/// The same as text of PLY, with more properties and rows.
fn ply(of_faces: &str, rest: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\n{of_faces}end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
         {rest}"
    )
}

#[test]
fn meshes_that_say_things_in_odd_ways_look_as_meant() {
    let folder = Folder::new();
    folder.holding("red.mtl", b"newmtl m\nKd 0.7843 0.0784 0.0784\n");
    folder.holding(
        "twice.mtl",
        b"newmtl m\nmap_Kd a.png\nnewmtl m\nKd 0.7843 0.0784 0.0784\n",
    );
    folder.holding("black.mtl", b"newmtl m\nKd 0 0 0\n");
    folder.holding("glass.mtl", b"newmtl m\nKd 0.7843 0.0784 0.0784\nd 0.2\n");
    folder.holding("a.png", &png_of(RED, 8));
    let paint = "#MRGB ffc81414ffc81414ffc81414ffc81414";
    let use_m = |library: &str| format!("mtllib {library}\nusemtl M");
    let files = [
        (
            "plain.obj",
            obj(&use_m("red.mtl").to_lowercase(), "f 1 2 3 4"),
        ),
        ("commas.obj", obj(&use_m("red.mtl"), "f 1,2,3,4")),
        (
            "blanks.obj",
            obj(&use_m("red.mtl"), "f 1 /1 2 /1 3 /1 4 /1 // all"),
        ),
        ("twice.obj", obj(&use_m("twice.mtl"), "f 1 2 3 4")),
        ("paint.obj", obj(paint, "f 1 2 3 4")),
        (
            "black.obj",
            obj(&use_m("black.mtl"), "f 1 2 3 4").replace(" 0\nv", " 0 200 20 20\nv"),
        ),
        ("glass.obj", obj(&use_m("glass.mtl"), "f 1/1 2/1 3/1 4/1")),
        (
            "material.ply",
            ply(
                "property list uchar int indices\nproperty int material_index\n\
                 element material 1\nproperty uchar red\nproperty uchar green\n\
                 property uchar blue\n",
                "4 1 2 3 4 0\n200 20 20\n",
            ),
        ),
    ];
    let mut names = Vec::new();
    for (name, text) in &files {
        folder.holding(name, text.as_bytes());
        names.push(*name);
    }
    let row = Row::of(&folder, &names);
    row.assert_alike(&names);
    for (name, times) in [
        ("faces_with_odd_signs", 5),
        ("materials_defined_twice", 1),
        ("materials_found_by_case", 5),
        ("black_under_colours", 1),
        ("drawn_opaque", 1),
        ("corners_of_another_name", 1),
        ("faces_from_one", 1),
    ] {
        assert_eq!(row.mended(name), times, "{name}: {}", row.told);
    }
    row.assert_remarks(&["drawn opaque: 1 material"]);
    row.assert_remarks(&["blanks within them"]);
}

/// Share of the pixels of a first picture that are not background.
fn lit(folder: &Folder, pack: &str, more: &[&str]) -> f64 {
    let out = folder.name("out");
    let frames = ["--frames", "1", "--view", "320x240", "--renderer", "cpu"];
    let all = [&["simulate", pack, "--out", &out], &frames[..], more].concat();
    done(&all);
    let picture = Rgb::read(&format!("{out}/frame_00000.png"));
    let background = picture.at([0, 0]);
    let [columns, rows] = picture.size;
    let all = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
    let lit = all.filter(|at| {
        picture
            .at(*at)
            .iter()
            .zip(background)
            .any(|(a, b)| a.abs_diff(b) > 8)
    });
    lit.count() as f64 / f64::from(columns * rows)
}

#[test]
fn thousands_of_small_parts_are_seen_in_the_first_picture_too() {
    let folder = Folder::new();
    let mut text = String::new();
    for number in 0..4000 {
        let [x, y] = [number % 80, number / 80].map(f64::from);
        for [across, along] in [[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]] {
            text += &format!("v {} {} 0\n", x + across, y + along);
        }
        text += "f -4 -3 -2 -1\n";
    }
    let file = folder.holding("leaves.obj", text.as_bytes());
    let pack = folder.name("leaves.foveal");
    let told = json(&["prepare", "scene", &file, "--out", &pack]);
    assert_eq!(told["leaf_triangles"], 8000);
    let whole = lit(&folder, &pack, &["--policy", "full"]);
    // Next to nothing can be fetched: what is there from the start is drawn.
    let first = lit(&folder, &pack, &["--policy", "uniform", "--budget", "1KB"]);
    assert!(whole > 0.005, "{whole}");
    assert!((0.5..2.0).contains(&(first / whole)), "{first} of {whole}");
}
