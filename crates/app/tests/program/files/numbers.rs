//! Do invalid numbers, lines out of order and missing rows cost no more than
//! themselves?

use super::meshes::{le_bytes, picture, prepared, shown};
use crate::support::{Folder, glb, json, refused};
use serde_json::{Value, json as value};

/// A square of two triangles as OBJ, before and behind more lines.
fn square(before: &str, behind: &str) -> Vec<u8> {
    format!("{before}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n{behind}\n").into()
}

/// What is expected of a file: so many triangles and points, and a mend by this name, or none.
type Expected<'a> = (u64, u64, &'a str);

/// Prepares a file and compares; every mend must be reported in words, too.
fn check(folder: &Folder, name: &str, bytes: &[u8], (triangles, points, mend): Expected<'_>) {
    let told = prepared(folder, name, bytes, &[]);
    let what = format!("{name}: {:?}: {told}", String::from_utf8_lossy(bytes));
    assert_eq!(told["leaf_triangles"], triangles, "{what}");
    assert_eq!(told["points"], points, "{what}");
    let remarks = told["remarks"].as_array().unwrap();
    match mend {
        "" => assert_eq!(remarks.len(), 0, "{what}"),
        _ => {
            assert!(told["repairs"][mend].as_u64() > Some(0), "{mend}: {what}");
            assert!(
                remarks
                    .iter()
                    .any(|it| it.as_str().unwrap().starts_with("a: ")),
                "{what}"
            );
            let again = json(&["info", &folder.name("a.foveal")]);
            assert_eq!(
                (&again["remarks"], &again["repairs"]),
                (&told["remarks"], &told["repairs"])
            );
        }
    }
}

#[test]
fn an_obj_loses_no_more_than_what_is_no_number_or_not_there() {
    let folder = Folder::new();
    let files: [(&str, &str, Expected<'_>); 16] = [
        (
            "# made\\",
            "v nan 0 0\nv -1.#IND 1 1\nv 1e999 0 0\n",
            (2, 0, ""),
        ),
        (
            "",
            "v 1.#QNAN 0 0\nf 1 2 5\n",
            (2, 0, "triangles_without_place"),
        ),
        (
            "",
            "v -nan(ind) 0 0\nf 1 2 3 5\n",
            (2, 0, "triangles_without_place"),
        ),
        ("", "f 2 3 99\n", (2, 0, "triangles_out_of_range")),
        ("", "f 4 3 x\nf 4 3 -9\n", (2, 0, "triangles_out_of_range")),
        (
            "",
            "v 5 0 0\nf 2//1 5//1 3//1\n",
            (3, 0, "normals_not_found"),
        ),
        ("", "v 5 0 0\nf 2/3 5/3 3/3\n", (3, 0, "uvs_not_found")),
        ("", "v 5 0 0\nf 2/0/0 5/0/0 3/0/0\n", (3, 0, "")),
        ("", "v 5 0 0 # far\nf 2 5 3 # the last\n", (3, 0, "")),
        (
            "f -1 1 2\nf 2 5 3",
            "v 5 0 0\n",
            (3, 0, "triangles_out_of_range"),
        ),
        ("f 2/1 5/1 3/1", "v 5 0 0\nvt 0 0\n", (3, 0, "")),
        ("vn nan nan nan", "v 5 0 0\nf 2//1 5//1 3//1\n", (3, 0, "")),
        (
            "vt nan -nan(ind)",
            "v 5 0 0\nf 2/1 5/1 3/1\n",
            (3, 0, "uvs_made"),
        ),
        ("", "v 0,5 0,5 9\nf 1 2 5\n", (3, 0, "decimal_commas")),
        ("", "v 5 0\nf 2 5 3\n", (3, 0, "coordinates_made")),
        ("", "V 5 0 0\nF 2 5.0 3e0\n", (3, 0, "")),
    ];
    for (before, behind, expected) in files {
        check(&folder, "a.obj", &square(before, behind), expected);
    }
    let from_zero = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 0 1 2\nf 0 2 3\n";
    let expected = (2, 0, "faces_from_zero");
    check(&folder, "a.obj", from_zero.as_bytes(), expected);
}

#[test]
fn an_obj_is_read_in_any_encoding_and_with_any_ends_of_lines() {
    let folder = Folder::new();
    let text = String::from_utf8(square("# Gr\u{fc}n", "")).unwrap();
    let of = |mark: &str, to: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("{mark}{text}")
            .encode_utf16()
            .flat_map(to)
            .collect()
    };
    for file in [
        of("\u{feff}", u16::to_le_bytes),
        of("\u{feff}", u16::to_be_bytes),
        of("", u16::to_le_bytes),
        format!("\u{feff}{text}").into_bytes(),
        text.replace('\n', "\r").into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
    ] {
        check(&folder, "a.obj", &file, (2, 0, ""));
    }
}

#[test]
fn materials_in_capitals_with_comments_or_in_utf_16_are_found() {
    let folder = Folder::new();
    let mesh = square("mtllib a.mtl\nUSEMTL red # it is", "");
    let library = "NEWMTL red\nKD 1 0 0 # red\nd none\n";
    let wide: Vec<u8> = library.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for library in [library.as_bytes(), &wide] {
        folder.holding("a.mtl", library);
        check(&folder, "a.obj", &mesh, (2, 0, "lines_broken"));
        let [red, green, blue] = picture(&folder).at([80, 80]);
        assert!(red > 100 && green < 20 && blue < 20, "{red} {green} {blue}");
    }
    let mesh = square("usemtl red", "mtllib a.mtl");
    folder.holding("a.mtl", b"newmtl red\nkd 1 0 0\n");
    check(&folder, "a.obj", &mesh, (2, 0, ""));
}

#[test]
fn vertices_alone_and_points_of_an_obj_are_a_cloud_in_their_colours() {
    let folder = Folder::new();
    let points = |colour: &str, count: u32| -> String {
        let point = |k: u32| format!("v {} {} 0{colour}\n", k % 40, k / 40);
        (0..count).map(point).collect()
    };
    let red = points(" 1 0 0", 1600);
    let bad = format!("{red}v nan nan nan 0 0 0\n");
    let all = (1..=1600).map(|it| it.to_string()).collect::<Vec<_>>();
    let named = format!("{red}p {}\n", all.join(" "));
    for (file, expected) in [
        (&red, (0, 1600, "")),
        (&named, (0, 1600, "")),
        (&bad, (0, 1600, "points_without_place")),
    ] {
        check(&folder, "a.obj", file.as_bytes(), expected);
        let seen = picture(&folder);
        let is_red = |at: &[u32; 2]| seen.at(*at)[0] > 150 && seen.at(*at)[1] < 60;
        let red = seen.places().filter(is_red).count();
        assert!(red > 1000, "{red} of {}", shown(&seen));
    }
    check(&folder, "a.obj", points("", 9).as_bytes(), (0, 9, ""));
    let mesh = square("", "v 3 0 0\nv 4 0 0\np 5 6\n");
    check(&folder, "a.obj", &mesh, (2, 2, ""));
    let lines = folder.holding("a.obj", b"v 0 0 0\nv 1 1 1\nl 1 2\n");
    let out = folder.name("a.foveal");
    refused(
        1,
        &["prepare", "scene", &lines, "--out", &out, "--force"],
        &["only lines (1)"],
    );
}

/// A square as PLY in text, or binary with the little end first.
fn ply(is_text: bool, places: &[[f32; 3]], faces: &[[i32; 3]]) -> Vec<u8> {
    let kind = if is_text {
        "ascii"
    } else {
        "binary_little_endian"
    };
    let list = "element face";
    let face = match faces.len() {
        0 => String::new(),
        count => format!("{list} {count}\nproperty list uchar int vertex_indices\n"),
    };
    let mut file = format!(
        "ply\nformat {kind} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\n{face}end_header\n",
        places.len()
    )
    .into_bytes();
    for place in places {
        match is_text {
            true => file.extend(format!("{} {} {}\n", place[0], place[1], place[2]).bytes()),
            false => file.extend(le_bytes(place)),
        }
    }
    for [a, b, c] in faces {
        match is_text {
            true => file.extend(format!("3 {a} {b} {c}\n").bytes()),
            false => {
                file.push(3);
                file.extend([a, b, c].iter().flat_map(|it| it.to_le_bytes()));
            }
        }
    }
    file
}

const CORNERS: [[f32; 3]; 5] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [f32::NAN, f32::INFINITY, 0.0],
];
const FACES: [[i32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

#[test]
fn a_ply_loses_no_more_than_rows_that_are_none_or_missing() {
    let folder = Folder::new();
    for is_text in [false, true] {
        check(
            &folder,
            "a.ply",
            &ply(is_text, &CORNERS, &FACES),
            (2, 0, ""),
        );
        let cloud = ply(is_text, &CORNERS, &[]);
        check(&folder, "a.ply", &cloud, (0, 4, "points_without_place"));
        let bad = [&FACES[..], &[[0, 1, 4]]].concat();
        let bad = ply(is_text, &CORNERS, &bad);
        check(&folder, "a.ply", &bad, (2, 0, "triangles_without_place"));
        let out = [&FACES[..], &[[0, 1, 5], [0, 1, -1]]].concat();
        let out = ply(is_text, &CORNERS, &out);
        check(&folder, "a.ply", &out, (2, 0, "triangles_out_of_range"));
        let whole = ply(is_text, &CORNERS[..4], &FACES);
        let cut = &whole[..whole.len() - 5];
        check(&folder, "a.ply", cut, (1, 0, "rows_missing"));
        let faceless = &whole[..whole.len() - if is_text { 16 } else { 26 }];
        check(&folder, "a.ply", faceless, (0, 4, "rows_missing"));
    }
    let text = String::from_utf8(ply(true, &CORNERS, &FACES)).unwrap();
    for nan in ["-nan(ind)", "1.#QNAN", "-1.#IND", "NAN"] {
        let text = text.replace("NaN", nan);
        check(&folder, "a.ply", text.as_bytes(), (2, 0, ""));
    }
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    check(&folder, "a.ply", &wide, (2, 0, ""));
    check(
        &folder,
        "a.ply",
        text.replace('\n', "\r").as_bytes(),
        (2, 0, ""),
    );
    let long = text.replace("1 0 0\n", "1 0 0 7 7\n");
    check(&folder, "a.ply", long.as_bytes(), (2, 0, "rows_too_long"));
}

#[test]
fn an_stl_loses_no_more_than_triangles_that_are_none_or_missing() {
    let folder = Folder::new();
    let corner = |it: i32| CORNERS[it as usize];
    let binary = |faces: &[[i32; 3]]| -> Vec<u8> {
        let mut file = b"solid but binary".to_vec();
        file.resize(80, 0);
        file.extend((faces.len() as u32).to_le_bytes());
        for face in faces {
            file.extend([0; 12]);
            file.extend(le_bytes(face.map(corner).as_flattened()));
            file.extend([0; 2]);
        }
        file
    };
    let text = |faces: &[[i32; 3]]| -> String {
        let mut text = "solid a\n".to_owned();
        for face in faces {
            text += "facet normal -nan(ind) 0 0\nouter loop\n";
            for [x, y, z] in face.map(corner) {
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
        text + "endsolid a\n"
    };
    let bad = [&FACES[..], &[[0, 1, 4]]].concat();
    let whole = binary(&FACES);
    let mut unfinished = whole.clone();
    unfinished[80..84].fill(0);
    let mut wide = vec![0xff, 0xfe];
    wide.extend(text(&FACES).encode_utf16().flat_map(u16::to_le_bytes));
    let cut = text(&FACES);
    for (file, expected) in [
        (binary(&bad), (2, 0, "triangles_without_place")),
        (text(&bad).into_bytes(), (2, 0, "triangles_without_place")),
        (whole[..whole.len() - 9].to_vec(), (1, 0, "rows_missing")),
        (
            cut.as_bytes()[..cut.len() - 40].to_vec(),
            (1, 0, "rows_missing"),
        ),
        (unfinished, (2, 0, "rows_beyond_count")),
        (wide, (2, 0, "")),
        ([text(&FACES).as_bytes(), &[0; 9]].concat(), (2, 0, "")),
        (text(&FACES).replace('\n', " ").into_bytes(), (2, 0, "")),
        (text(&FACES).to_uppercase().into_bytes(), (2, 0, "")),
    ] {
        check(&folder, "a.stl", &file, expected);
    }
}

#[test]
fn a_gltf_vertex_at_infinity_costs_its_triangles() {
    let folder = Folder::new();
    let mut binary = le_bytes(CORNERS.as_flattened());
    let corners = [0_u32, 1, 2, 0, 2, 3, 0, 1, 4, 0, 1, 5];
    binary.extend(corners.iter().flat_map(|it| it.to_le_bytes()));
    let document = |count: usize| {
        value!({
            "asset": {"version": "2.0"},
            "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 5},
                {"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": count}],
            "bufferViews": [
                {"buffer": 0, "byteLength": 60},
                {"buffer": 0, "byteOffset": 60, "byteLength": 48}],
            "buffers": [{"byteLength": 108}],
        })
    };
    for (count, expected) in [
        (6, (2, 0, "")),
        (9, (2, 0, "triangles_without_place")),
        (12, (2, 0, "triangles_out_of_range")),
    ] {
        check(&folder, "a.glb", &glb(&document(count), &binary), expected);
    }
}

/// LAS 1.2 of so many points of format 0 that the header counts, and those that are there.
fn las(told: u32, there: u32) -> Vec<u8> {
    let mut file = b"LASF".to_vec();
    file.resize(227, 0);
    file[24..26].copy_from_slice(&[1, 2]);
    file[94..96].copy_from_slice(&227_u16.to_le_bytes());
    file[96..100].copy_from_slice(&227_u32.to_le_bytes());
    file[105..107].copy_from_slice(&20_u16.to_le_bytes());
    file[107..111].copy_from_slice(&told.to_le_bytes());
    for axis in 0..3 {
        let at = 131 + 8 * axis;
        file[at..at + 8].copy_from_slice(&0.01_f64.to_le_bytes());
    }
    for point in 0..there {
        let place = [point % 10, point / 10, 0];
        file.extend(place.iter().flat_map(|it| it.to_le_bytes()));
        file.extend([0; 8]);
    }
    file
}

#[test]
fn a_las_that_was_cut_off_shows_the_points_that_are_there() {
    let folder = Folder::new();
    check(&folder, "a.las", &las(100, 100), (0, 100, ""));
    let cut = las(100, 100);
    check(
        &folder,
        "a.las",
        &cut[..cut.len() - 30],
        (0, 98, "missing_points"),
    );
}

#[test]
fn strict_preparation_refuses_what_would_be_mended_and_names_it() {
    let folder = Folder::new();
    let out = folder.name("a.foveal");
    let bad = folder.holding("bad.obj", &square("", "f 1 2 9"));
    let arguments = ["prepare", "scene", &bad, "--out", &out];
    let strict = [&arguments[..], &["--strict"]].concat();
    let words = [
        "bad.obj",
        "triangles out of range: 1",
        "in line 8",
        "without --strict",
    ];
    refused(1, &strict, &words);
    refused(1, &[&strict[..], &["--dry-run"]].concat(), &words);
    assert_eq!(folder.names(), ["bad.obj"], "nothing is left");
    json(&arguments);
    // Also of a pack that is there.
    refused(1, &strict, &words);
    // An edge that two triangles walk the same way stays as it is.
    let good = folder.holding("good.obj", &square("", "v 5 0 0\nf 2 3 5\n"));
    let out = folder.name("good.foveal");
    let told: Value = json(&["prepare", "scene", &good, "--out", &out, "--strict"]);
    assert_eq!(
        told["repairs"],
        value!({"mixed_winding_edges": 1}),
        "{told}"
    );
}
