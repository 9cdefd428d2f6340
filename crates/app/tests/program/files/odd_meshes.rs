//! Are meshes whole whose numbers run together, whose strips restart, or that are huge?

use super::meshes::{le_bytes, prepared};
use super::row::Row;
use crate::support::{Folder, refused};
use serde_json::{Value, json as value};

#[test]
fn numbers_that_run_together_are_read_where_the_columns_ask_for_it() {
    let folder = Folder::new();
    let corners = "v 1 1 0\nv 0 1 0\n";
    let faces = "f 1 2 3\nf 1 3 4\n";
    let files = [
        (
            "commas",
            "v 0,0,0\nv 1.0,0.0,0.0\n",
            2,
            "numbers_without_blanks",
        ),
        ("letters", "v 0.f 0.0f 0f\nv 1.0F 0 0d\n", 2, ""),
        ("fortran", "v 0.0D+00 0 0\nv 1.0D+00 0.5-103 0\n", 2, ""),
        (
            "glued",
            "v 0.0-0.0 0\nv 1.0-0.0-0.0\n",
            2,
            "numbers_without_blanks",
        ),
        (
            "exponents",
            "v 0 0 0\nv 1e+0-0.0e-3-0E1\n",
            2,
            "numbers_without_blanks",
        ),
        ("too many", "v 0 0 0\nv 1.0-0.0 0 0\n", 1, "lines_broken"),
    ];
    for (name, before, triangles, mend) in files {
        let text = format!("{before}{corners}{faces}");
        let told = prepared(&folder, "a.obj", text.as_bytes(), &[]);
        assert_eq!(told["leaf_triangles"], triangles, "{name}: {told}");
        if mend.is_empty() && name != "fortran" {
            assert_eq!(told["repairs"], value!({}), "{name}");
        }
        if !mend.is_empty() {
            assert!(told["repairs"][mend].as_u64() > Some(0), "{name}: {told}");
            let remarks = told["remarks"].to_string();
            assert!(remarks.contains("the first in line 2") || remarks.contains("in line 1"));
        }
    }
}

#[test]
fn numbers_of_stl_that_run_together_are_read_in_any_lines() {
    let folder = Folder::new();
    for between in ["\n", " "] {
        let lines = [
            "solid a",
            "facet normal 0 0 1",
            "outer loop",
            "vertex 0.0-0.0 0",
        ];
        let more = [
            "vertex 1.-0.-0.",
            "vertex 1f,1.0f,0",
            "endloop",
            "endfacet",
            "endsolid a",
        ];
        let text = [&lines[..], &more].concat().join(between);
        let told = prepared(&folder, "a.stl", text.as_bytes(), &[]);
        assert_eq!(told["leaf_triangles"], 1, "{told}");
        assert!(
            told["repairs"]["numbers_without_blanks"].as_u64() > Some(0),
            "{told}"
        );
    }
}

/// A `.glb` of two squares, a metre wide each, whose part has these indices.
fn squares(indices: &[u8], component: u32, mode: u32, more: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut places: Vec<f32> = Vec::new();
    for begin in [0.0, 2.0] {
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            places.extend([begin + x, y, 0.0]);
        }
    }
    let mut binary = le_bytes(&places);
    let begin = binary.len();
    binary.extend(indices);
    binary.resize(binary.len().next_multiple_of(4), 0);
    let size = match component {
        5121 => 1,
        5123 => 2,
        _ => 4,
    };
    let document = value!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}
        ]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": component, "count": indices.len() / size,
             "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": begin},
            {"buffer": 0, "byteOffset": begin, "byteLength": indices.len()}
        ],
        "buffers": [{"byteLength": binary.len()}]
    });
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    let mut chunks: Vec<(&[u8; 4], &[u8])> = vec![(b"JSON", &json)];
    chunks.extend(more);
    chunks.push((b"BIN\0", &binary));
    for (kind, chunk) in chunks {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

#[test]
fn strips_that_are_begun_again_and_chunks_of_other_kinds_lose_no_triangle() {
    let folder = Folder::new();
    let two = |all: &[u16]| -> Vec<u8> { all.iter().flat_map(|it| it.to_le_bytes()).collect() };
    let four = |all: &[u32]| -> Vec<u8> { all.iter().flat_map(|it| it.to_le_bytes()).collect() };
    let end = u16::MAX;
    let files = [
        ("strip of bytes", vec![0, 1, 3, 2, 255, 4, 5, 7, 6], 5121, 5),
        (
            "strip",
            two(&[0, 1, 3, 2, end, end, 4, 5, 7, 6, end]),
            5123,
            5,
        ),
        (
            "strip of words",
            four(&[0, 1, 3, 2, u32::MAX, 4, 5, 7, 6]),
            5125,
            5,
        ),
        (
            "signed strip",
            four(&[0, 1, 3, 2, u32::MAX, 4, 5, 7, 6]),
            5124,
            5,
        ),
        ("fan", two(&[0, 1, 2, 3, end, 4, 5, 6, 7]), 5123, 6),
        (
            "list",
            two(&[0, 1, 2, 0, 2, 3, end, 4, 5, 6, 4, 6, 7]),
            5123,
            4,
        ),
    ];
    for (name, indices, component, mode) in files {
        let bytes = squares(&indices, component, mode, &[]);
        let told = prepared(&folder, "a.glb", &bytes, &[]);
        assert_eq!(told["leaf_triangles"], 4, "{name}: {told}");
        assert!(
            told["repairs"]["strips_begun_again"].as_u64() > Some(0),
            "{name}: {told}"
        );
        assert!(
            told["repairs"]["triangles_out_of_range"].is_null(),
            "{name}: {told}"
        );
    }
    // In a list that is one corner too long it is a mistake.
    let list = two(&[0, 1, 2, 0, 2, end, 4, 5, 6]);
    let told = prepared(&folder, "a.glb", &squares(&list, 5123, 4, &[]), &[]);
    assert_eq!(told["leaf_triangles"], 2, "{told}");
    assert_eq!(told["repairs"]["triangles_out_of_range"], 1, "{told}");
    let strip = [0, 1, 3, 2, 2, 4, 4, 5, 7, 6];
    let more: &[(&[u8; 4], &[u8])] = &[(b"XXXX", b"abcd"), (b"JSN2", b"")];
    for name in ["a.glb", "a.vrm"] {
        let told = prepared(&folder, name, &squares(&strip, 5121, 5, more), &[]);
        assert_eq!(told["leaf_triangles"], 4, "{told}");
    }
}

#[test]
fn meshes_of_any_size_are_lit_alike_and_what_is_not_read_is_named() {
    let folder = Folder::new();
    let square = |size: &str| {
        let [near, far] = ["0", size];
        format!(
            "v {near} {near} 0\nv {far} {near} 0\nv {far} {far} 0\nv {near} {far} 0\n\
             f 1 2 3 4\n"
        )
    };
    let mut lights: Vec<Value> = Vec::new();
    for size in ["1", "1e12", "1e-8", "1e6"] {
        let told = prepared(&folder, "a.obj", square(size).as_bytes(), &[]);
        assert_eq!(told["leaf_triangles"], 2, "{size}: {told}");
        let picture = super::meshes::picture(&folder);
        lights.push(value!(picture.at([80, 80])));
    }
    assert!(lights.iter().all(|it| *it == lights[0]), "{lights:?}");
    let told = prepared(&folder, "a.obj", square("1e-12").as_bytes(), &[]);
    assert!(
        told["remarks"].to_string().contains("1.0e-12 m across"),
        "{told}"
    );
    let dark = square("1")
        .replace(" 0\nv", " 0 0 0 0\nv")
        .replace(" 0\nf", " 0 0 0 0\nf");
    let told = prepared(&folder, "a.obj", dark.as_bytes(), &[]);
    assert_eq!(told["repairs"]["black_surfaces"], 1, "{told}");
    folder.holding("a.obj", square("1").as_bytes());
    let named = format!("call b.obj\nusemap wood\n{}", square("1"));
    folder.holding("b.obj", named.as_bytes());
    let row = Row::of(&folder, &["a.obj", "b.obj"]);
    row.assert_alike(&["a.obj", "b.obj"]);
    row.assert_remarks(&["\"b.obj\"", "call", "left out"]);
    row.assert_remarks(&["\"wood\"", "usemap"]);
    folder.holding("c.mtl", b"newmtl red\nKd 0.8f 0.0f 0\n");
    let lost = format!("mtllib lost.mtl\nusemtl red\n{}", square("1"));
    folder.holding("c.obj", lost.as_bytes());
    let row = Row::of(&folder, &["c.obj"]);
    assert!(
        row.colours[0][0] > 60 + row.colours[0][1],
        "{:?}",
        row.colours
    );
    row.assert_remarks(&["\"c.mtl\"", "next to the model", "used"]);
    let none = folder.holding("none.obj", b"f 1 2\n");
    let arguments = [
        "prepare",
        "scene",
        &none,
        "--out",
        &folder.name("none.foveal"),
    ];
    refused(1, &arguments, &["none.obj", "`f 1 2 3`", "`v 0 0 1`"]);
}

#[test]
fn what_is_wholly_transparent_is_not_drawn_and_told() {
    let folder = Folder::new();
    let quad = |z: f64| {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
        corners.map(|[x, y]| format!("v {x} {y} {z}\n")).concat()
    };
    let hull = |mtl: &str| {
        folder.holding("hull.mtl", b"newmtl red\nKd 0.8 0 0\n");
        folder.holding(
            "more.mtl",
            format!("newmtl hull\nKd 0 0 1\n{mtl}").as_bytes(),
        );
        let (back, front) = (quad(0.0), quad(0.5));
        format!(
            "mtllib hull.mtl\nmtllib more.mtl\n{back}{front}usemtl red\nf 1 2 3 4\nusemtl hull\n\
             f 5 6 7 8\n"
        )
    };
    let plain = format!("mtllib hull.mtl\n{}usemtl red\nf 1 2 3 4\n", quad(0.0));
    folder.holding("plain.obj", plain.as_bytes());
    for mtl in ["d 0\n", "Tr 1\n"] {
        folder.holding("hull.obj", hull(mtl).as_bytes());
        let row = Row::of(&folder, &["plain.obj", "hull.obj"]);
        row.assert_alike(&["plain.obj", "hull.obj"]);
        row.assert_remarks(&["wholly transparent", "2 triangles of 1 material", "hull"]);
        assert_eq!(row.mended("triangles_hidden"), 2, "{}", row.told);
        assert_eq!(row.mended("drawn_opaque"), 0, "{}", row.told);
    }
    // Two lines that say the opposite; a file of nothing else; and half of it.
    let all = plain
        .replace("usemtl red", "usemtl hull")
        .replace("hull.mtl", "more.mtl");
    for (mtl, repair, word) in [
        ("d 1\nTr 1\n", "opacities_said_twice", "`d` counts"),
        ("d 0\n", "drawn_opaque", "as nothing would be seen"),
        ("d 0.5\n", "drawn_opaque", "half transparent"),
    ] {
        hull(mtl);
        let told = prepared(&folder, "all.obj", all.as_bytes(), &[]);
        assert_eq!(told["repairs"][repair], 1, "{told}");
        assert!(told["remarks"].to_string().contains(word), "{told}");
    }
    // A file that breaks off within a face.
    let cut = format!("{}f 1 2 3\nf 1 3", quad(0.0));
    let told = prepared(&folder, "cut.obj", cut.as_bytes(), &[]);
    let remarks = told["remarks"].to_string();
    assert!(
        remarks.contains("fewer than three corners") && remarks.contains("line 6"),
        "{told}"
    );
}
