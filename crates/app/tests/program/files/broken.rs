//! Does what is broken in a file cost that alone, and is nothing shown wrong without a word?

use super::meshes::{le_bytes, picture, prepared, shown};
use super::row::png_of;
use crate::support::{Folder, done, frame_picture, glb, json as told_by, refused};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Triangles of a square.
const SQUARE: u64 = 2;

/// Two squares next to each other, each a mesh of its own, and their bytes.
fn squares() -> (Value, Vec<u8>) {
    let corners = [[0.0_f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let places: Vec<f32> = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect();
    let normals = [0.0_f32, 0.0, 1.0].repeat(4);
    let uvs: Vec<f32> = corners.iter().flat_map(|[x, y]| [*x, 1.0 - *y]).collect();
    let mut binary = [places, normals, uvs].map(|it| le_bytes(&it)).concat();
    let indices = [0_u16, 1, 2, 0, 2, 3];
    binary.extend(indices.iter().flat_map(|it| it.to_le_bytes()));
    let part = json!({"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3});
    // Meshes that say the same would be one.
    let mut other = part.clone();
    other["mode"] = json!(4);
    let document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"mesh": 1, "translation": [1.5, 0, 0]}],
        "meshes": [{"primitives": [part]}, {"primitives": [other]}],
        "materials": [{}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 48},
            {"buffer": 0, "byteOffset": 96, "byteLength": 32},
            {"buffer": 0, "byteOffset": 128, "byteLength": 12},
        ],
        "buffers": [{"byteLength": 140}],
    });
    (document, binary)
}

#[test]
fn what_is_broken_in_gltf_costs_its_part_and_is_told() {
    type Change = fn(&mut Value);
    let changes: [(&str, u64, Change); 12] = [
        ("scenes_not_found", 2, |j| j["scene"] = json!(7)),
        ("nodes_not_found", 1, |j| j["nodes"][1]["mesh"] = json!(7)),
        ("materials_not_found", 2, |j| {
            j["meshes"][1]["primitives"][0]["material"] = json!(7);
        }),
        ("parts_left_out", 1, |j| {
            j["meshes"][1]["primitives"][0]["indices"] = json!(7);
        }),
        ("attributes_left_out", 2, |j| {
            j["meshes"][1]["primitives"][0]["attributes"]["NORMAL"] = json!(7);
        }),
        ("attributes_of_another_length", 2, |j| {
            j["accessors"][1]["count"] = json!(3);
        }),
        ("accessors_cut", 2, |j| {
            j["accessors"][0]["count"] = json!(99);
        }),
        ("views_cut", 2, |j| {
            j["bufferViews"][3]["byteLength"] = json!(9999);
        }),
        ("json_mended", 2, |j| {
            j["bufferViews"][0]["byteOffset"] = json!("0");
        }),
        ("nodes_in_themselves", 2, |j| {
            j["nodes"][1]["children"] = json!([1]);
        }),
        ("nodes_with_several_parents", 2, |j| {
            j["nodes"] = json!([{"children": [2]}, {"children": [2]}, {"mesh": 0}]);
        }),
        ("places_mended", 2, |j| {
            j["nodes"][1]["rotation"] = json!([0, 0, 0, 0]);
        }),
    ];
    let folder = Folder::new();
    for (name, shown, change) in changes {
        let (mut document, binary) = squares();
        change(&mut document);
        let input = folder.holding("a.glb", &glb(&document, &binary));
        let arguments = ["prepare", "scene", &input, "--dry-run"];
        let told = told_by(&arguments);
        let times = told["repairs"][name].as_u64();
        assert!(times.is_some_and(|it| it > 0), "{name}: {told}");
        let placed = if name == "nodes_with_several_parents" {
            1
        } else {
            shown
        };
        assert_eq!(told["triangles"], placed * SQUARE, "{name}: {told}");
        let is_kept = [&arguments[..], &["--strict"]].concat();
        let words = name.replace('_', " ");
        refused(1, &is_kept, &["--strict", &words]);
    }
}

/// A sheet of 24 x 24 squares, each face there again, reversed.
fn sheet(is_of_triangles: bool, back: &str) -> String {
    let mut text = "mtllib a.mtl\nusemtl front\n".to_owned();
    for k in 0..625 {
        let [x, y] = [k % 25, k / 25].map(|it| f64::from(it) / 24.0);
        let _ = writeln!(text, "v {x} {y} {}", 0.05 * (6.0 * x).sin());
    }
    let squares = (0..576).map(|k| k / 24 * 25 + k % 24 + 1);
    let faces: Vec<Vec<u32>> = squares
        .flat_map(|a| match is_of_triangles {
            true => vec![vec![a, a + 1, a + 26], vec![a, a + 26, a + 25]],
            false => vec![vec![a, a + 1, a + 26, a + 25]],
        })
        .collect();
    let mut write = |face: &mut dyn Iterator<Item = &u32>| {
        text.push('f');
        face.for_each(|corner| write!(text, " {corner}").unwrap());
        text.push('\n');
    };
    faces.iter().for_each(|face| write(&mut face.iter()));
    let mut backs = String::new();
    for face in &faces {
        let corners: Vec<String> = face.iter().rev().map(u32::to_string).collect();
        let _ = writeln!(backs, "f {}", corners.join(" "));
    }
    format!("{text}usemtl {back}\n{backs}")
}

#[test]
fn a_sheet_whose_faces_are_there_again_reversed_is_one_surface_with_two_sides() {
    let folder = Folder::new();
    folder.holding("a.mtl", b"newmtl front\nKd 1 0 0\nnewmtl back\nKd 0 0 1\n");
    for (is_of_triangles, back, triangles) in [
        (true, "front", 1152),
        (false, "front", 1152),
        (true, "back", 2304),
    ] {
        let text = sheet(is_of_triangles, back);
        let told = prepared(&folder, "a.obj", text.as_bytes(), &["--strict"]);
        assert_eq!(told["leaf_triangles"], triangles, "{told}");
        assert_eq!(told["repairs"]["two_sided_faces"], 1152, "{told}");
        let pack = folder.name("a.foveal");
        let checked = told_by(&["verify", &pack, "--cuts", "8", "--orders", "8"]);
        assert_eq!(checked["odd_edges_max"], checked["source_odd_edges"]);
        // The coarsest level covers what the finest does, as an open sheet's does.
        let full = shown(&picture(&folder));
        let out = folder.name("coarse");
        let view = [
            "--policy",
            "coarsest",
            "--view",
            "160x160",
            "--renderer",
            "cpu",
        ];
        done(
            &[
                &["simulate", &pack, "--out", &out, "--frames", "1"],
                &view[..],
            ]
            .concat(),
        );
        let coarse = shown(&frame_picture(&out, 0));
        assert!(coarse * 10 >= full * 9, "{coarse} of {full}");
    }
}

/// A binary STL square of two triangles, whose last two bytes are these.
fn stl(head: &[u8], words: [u16; 2]) -> Vec<u8> {
    let mut file = head.to_vec();
    file.resize(80, 0);
    file.extend(2_u32.to_le_bytes());
    for (corners, word) in [[0, 1, 2], [0, 2, 3]].iter().zip(words) {
        let places = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let numbers: Vec<f32> = corners.iter().flat_map(|it: &usize| places[*it]).collect();
        file.extend(le_bytes(&[0.0, 0.0, 1.0]));
        file.extend(le_bytes(&numbers));
        file.extend(word.to_le_bytes());
    }
    file
}

/// Which of red, green and blue are seen most.
fn colours(folder: &Folder) -> [bool; 3] {
    let picture = picture(folder);
    [0, 1, 2].map(|k| {
        let mut all = picture.places();
        all.any(|at| {
            let colour = picture.at(at);
            let others = (0..3).filter(|other| *other != k);
            let most = others.map(|other| colour[other]).max().unwrap_or(0);
            colour[k] > 120 && most < 60
        })
    })
}

#[test]
fn colours_of_stl_and_packed_colours_of_ply_are_shown() {
    let folder = Folder::new();
    let [red, blue] = [0x8000 | 31 << 10, 0x8000 | 31];
    for (head, words, expected) in [
        (&b""[..], [red, blue], [true, false, true]),
        (b"COLOR=\0\xff\0\xff", [31, 0x8000], [true, true, false]),
        (b"COLOR=\0\xff\0\xff", [0, 0], [false, true, false]),
    ] {
        let file = stl(head, words);
        prepared(&folder, "a.stl", &file, &["--up", "y", "--strict"]);
        assert_eq!(colours(&folder), expected, "{words:?}");
    }
    let told = prepared(&folder, "a.stl", &stl(b"", [7, 9]), &[]);
    assert!(told["remarks"][0].as_str().unwrap().contains("no colours"));
    let head = "ply\nformat ascii 1.0\nelement vertex 900\nproperty float x\nproperty float y\n\
        property float z\n";
    let cloud = |property: &str, value: &str| {
        let places = (0..900).map(|k| format!("{} {} 0 {value}\n", k % 30, k / 30));
        let rows: String = places.collect();
        format!("{head}property {property}\nend_header\n{rows}")
    };
    let packed = f32::from_bits(0x00ff_0000);
    for (property, value, expected) in [
        ("float rgb", packed.to_string(), [true, false, false]),
        (
            "uint rgba",
            0xff00_00ff_u32.to_string(),
            [false, false, true],
        ),
    ] {
        let file = cloud(property, &value);
        prepared(&folder, "a.ply", file.as_bytes(), &["--strict"]);
        assert_eq!(colours(&folder), expected, "{property}");
    }
    for (property, words) in [("float intensity", "grey"), ("uchar red", "left out")] {
        let told = prepared(&folder, "a.ply", cloud(property, "200").as_bytes(), &[]);
        let remark = told["remarks"][0].as_str().unwrap();
        assert!(remark.contains(words), "{remark}");
    }
}

#[test]
fn materials_that_say_colours_in_other_ways_are_shown_so_and_told() {
    let folder = Folder::new();
    folder.holding("t.png", &png_of([0, 255, 0], 8));
    let square = "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n\
        vt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    for (said, name, expected) in [
        ("Kd 255 0 0", "colours_rescaled", [true, false, false]),
        (
            "map_Ka t.png",
            "pictures_of_other_kinds",
            [false, true, false],
        ),
        (
            "Kd 0 0 0\nKe 0 0 1",
            "lights_shown_as_colours",
            [false, false, true],
        ),
    ] {
        folder.holding("a.mtl", format!("newmtl a\n{said}\n").as_bytes());
        let told = prepared(&folder, "a.obj", square.as_bytes(), &[]);
        assert_eq!(told["repairs"][name], 1, "{told}");
        assert_eq!(colours(&folder), expected, "{said}");
    }
    folder.holding("a.mtl", b"newmtl a\nmap_Kd t.png\n");
    let whole = png_of([0, 255, 0], 8);
    let mut wrong = whole.clone();
    wrong[29] ^= 1;
    for (what, bytes) in [("end", &whole[..whole.len() - 12]), ("sums", &wrong)] {
        folder.holding("t.png", bytes);
        let told = prepared(&folder, "a.obj", square.as_bytes(), &[]);
        assert_eq!(told["repairs"]["damaged_images"], 1, "{what}: {told}");
        assert_eq!(colours(&folder), [false, true, false], "{what}");
    }
    let line = folder.holding("line.obj", b"v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
    refused(
        1,
        &["prepare", "scene", &line, "--dry-run"],
        &["nothing to draw"],
    );
}
