//! Are textures of which a part is seen, and faces with any outline, drawn as they were meant?

use crate::support::{Folder, Rgb, done, frame_picture, glb, json};
use serde_json::{Value, json as value};
use std::f64::consts::TAU;
use std::fmt::Write as _;

pub(super) fn le_bytes(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|it| it.to_le_bytes()).collect()
}

/// What comes of a file: what `prepare` says of it.
pub(super) fn prepared(folder: &Folder, name: &str, bytes: &[u8], more: &[&str]) -> Value {
    let input = folder.holding(name, bytes);
    let pack = folder.name("a.foveal");
    let arguments = ["prepare", "scene", &input, "--out", &pack, "--force"];
    json(&[&arguments[..], more].concat())
}

/// The picture of the pack that was prepared last.
pub(super) fn picture(folder: &Folder) -> Rgb {
    let out = folder.name("out");
    let pack = folder.name("a.foveal");
    let arguments = ["simulate", &pack, "--out", &out, "--frames", "1"];
    let view = ["--policy", "full", "--view", "160x160", "--renderer", "cpu"];
    done(&[&arguments[..], &view].concat());
    frame_picture(&out, 0)
}

/// Pixels that show more than what lies behind everything.
pub(super) fn shown(picture: &Rgb) -> usize {
    let behind = picture.at([0, 0]);
    picture
        .places()
        .filter(|at| picture.at(*at) != behind)
        .count()
}

/// A picture of squares in red and green, with a palette or not.
fn squares(side: u32, has_palette: bool) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side, side);
    let code = |x: u32, y: u32| u8::from((x / 32 + y / 32).is_multiple_of(2));
    let all = (0..side).flat_map(|y| (0..side).map(move |x| code(x, y)));
    let data: Vec<u8> = if has_palette {
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(vec![200, 0, 0, 0, 200, 0]);
        all.collect()
    } else {
        encoder.set_color(png::ColorType::Rgb);
        all.flat_map(|code| [200 * code, 200 * (1 - code), 0])
            .collect()
    };
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&data).unwrap();
    drop(writer);
    file
}

/// Vertices, places on a texture, and triangles.
type Grid = (Vec<[f64; 2]>, Vec<[f64; 2]>, Vec<[u32; 3]>);

/// Vertices (i/8, j/8) and 128 triangles, whose places on a texture are a part of it.
fn grid(part: f64, begin: f64) -> Grid {
    let places = (0..81).map(|k| [f64::from(k % 9) / 8.0, f64::from(k / 9) / 8.0]);
    let places: Vec<[f64; 2]> = places.collect();
    let uvs = places.iter().map(|it| it.map(|along| along * part + begin));
    let uvs = uvs.collect();
    let cells = (0..8).flat_map(|j| (0..8).map(move |i| 9 * j + i));
    let triangles = cells.flat_map(|at| [[at, at + 1, at + 10], [at, at + 10, at + 9]]);
    (places, uvs, triangles.collect())
}

fn grid_obj(part: f64) -> String {
    let (places, uvs, triangles) = grid(part, 0.05);
    let mut text = "mtllib a.mtl\nusemtl a\n".to_owned();
    for ([x, y], [u, v]) in places.iter().zip(&uvs) {
        let _ = writeln!(text, "v {x} {y} 0\nvt {u} {v}");
    }
    for triangle in &triangles {
        let [a, b, c] = triangle.map(|it| it + 1);
        let _ = writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}");
    }
    text
}

fn grid_glb(part: f64, picture: &[u8]) -> Vec<u8> {
    let (places, uvs, triangles) = grid(part, 0.5);
    let flat = |all: &[[f64; 2]], depth: &[f32]| -> Vec<f32> {
        let pairs = all.iter().map(|it| it.map(|along| along as f32));
        pairs.flat_map(|it| [&it[..], depth].concat()).collect()
    };
    let parts = [
        le_bytes(&flat(&places, &[0.0])),
        le_bytes(&flat(&uvs, &[])),
        triangles
            .as_flattened()
            .iter()
            .flat_map(|it| it.to_le_bytes())
            .collect(),
        picture.to_vec(),
    ];
    let mut begin = 0;
    let views = parts.iter().map(|part| {
        begin += part.len();
        value!({"buffer": 0, "byteOffset": begin - part.len(), "byteLength": part.len()})
    });
    let views: Vec<Value> = views.collect();
    let document = value!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 81},
            {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 81},
            {"bufferView": 2, "componentType": 5125, "type": "SCALAR", "count": 384}],
        "bufferViews": views,
        "buffers": [{"byteLength": begin}],
    });
    glb(&document, &parts.concat())
}

#[test]
fn textures_of_which_a_part_is_seen_are_prepared_and_drawn() {
    let folder = Folder::new();
    folder.holding("a.mtl", b"newmtl a\nmap_Kd squares.png\n");
    let check = |told: &Value, side: u64| {
        assert_eq!(told["texels"], side * side, "{told}");
        assert_eq!(
            (&told["repairs"], &told["remarks"]),
            (&value!({}), &value!([]))
        );
        let seen = picture(&folder);
        let of = |k: usize| {
            let is_strong = |at: &[u32; 2]| seen.at(*at)[k] / 3 > seen.at(*at)[1 - k].max(20);
            seen.places().filter(is_strong).count()
        };
        assert!(of(0) > 500 && of(1) > 500, "{} {}", of(0), of(1));
    };
    for (side, part, exact) in [
        (512, 0.5, &[][..]),
        (1024, 0.4, &[]),
        (2048, 0.2, &["--exact"]),
    ] {
        folder.holding("squares.png", &squares(side, side == 512));
        let told = prepared(&folder, "a.obj", grid_obj(part).as_bytes(), exact);
        check(&told, side.into());
    }
    let side = 4096;
    let file = grid_glb(0.25, &squares(side, true));
    check(&prepared(&folder, "a.glb", &file, &[]), side.into());
    done(&["verify", &folder.name("a.foveal")]);
}

/// The outline of a star, and the same with a corner in its middle.
fn star() -> Vec<[f64; 2]> {
    let corner = |k: u32| {
        let angle = TAU / 4.0 + TAU / 10.0 * f64::from(k);
        let r = if k.is_multiple_of(2) { 2.0 } else { 0.8 };
        [r * angle.cos(), r * angle.sin()]
    };
    (0..10).map(corner).collect()
}

fn obj_of(outline: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for [x, y] in outline {
        let _ = writeln!(text, "v {x} {y} 0");
    }
    text += "f";
    for corner in 1..=outline.len() {
        let _ = write!(text, " {corner}");
    }
    text + "\n"
}

fn ply_of(outline: &[[f64; 2]]) -> String {
    let count = outline.len();
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    );
    for [x, y] in outline {
        let _ = writeln!(text, "{x} {y} 0");
    }
    let corners: Vec<String> = (0..count).map(|it| it.to_string()).collect();
    let _ = writeln!(text, "{count} {}", corners.join(" "));
    text
}

fn stl_of(outline: &[[f64; 2]]) -> String {
    let mut text = "solid a\nfacet normal 0 0 1\nouter loop\n".to_owned();
    for [x, y] in outline {
        let _ = writeln!(text, "vertex {x} {y} 0");
    }
    text + "endloop\nendfacet\nendsolid a\n"
}

/// One fan from the first corner.
fn fan_of(outline: &[[f64; 2]]) -> Vec<u8> {
    let numbers = outline
        .iter()
        .flat_map(|[x, y]| [*x as f32, *y as f32, 0.0]);
    let binary = le_bytes(&numbers.collect::<Vec<f32>>());
    let document = value!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]}],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": outline.len()}],
        "bufferViews": [{"buffer": 0, "byteLength": binary.len()}],
        "buffers": [{"byteLength": binary.len()}],
    });
    glb(&document, &binary)
}

#[test]
fn a_star_shaped_face_keeps_its_area() {
    let folder = Folder::new();
    let star = star();
    // The same in triangles round its middle.
    let mut whole = obj_of(&star)
        .lines()
        .take(10)
        .collect::<Vec<_>>()
        .join("\n")
        + "\nv 0 0 0\n";
    for corner in 1..=10 {
        let _ = writeln!(whole, "f {corner} {} 11", corner % 10 + 1);
    }
    prepared(&folder, "a.obj", whole.as_bytes(), &[]);
    let whole = shown(&picture(&folder));
    for (name, file) in [
        ("a.obj", obj_of(&star).into_bytes()),
        ("a.ply", ply_of(&star).into_bytes()),
        ("a.stl", stl_of(&star).into_bytes()),
        ("a.glb", fan_of(&star)),
    ] {
        let up = ["--up", "y"];
        let told = prepared(&folder, name, &file, &up);
        assert_eq!(told["leaf_triangles"], 8, "{name}: {told}");
        let found = shown(&picture(&folder));
        assert!(
            found.abs_diff(whole) <= whole / 50,
            "{name}: {found} of {whole}"
        );
    }
}

#[test]
fn faces_with_holes_straight_edges_and_crossings_are_filled() {
    let folder = Folder::new();
    let area = |outline: &[[f64; 2]], up: f64| {
        let file = obj_of(outline).replace(" 0\n", &format!(" {up}\n"));
        let told = prepared(&folder, "a.obj", file.as_bytes(), &[]);
        let tried = json(&["verify", &folder.name("a.foveal")]);
        assert_eq!(tried["ok"], true, "{tried}");
        (told, shown(&picture(&folder)))
    };
    let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let (_, full) = area(&square, 0.0);
    let bridge = [
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ];
    let (told, holed) = area(&[&square[..], &bridge].concat(), 1e-4);
    assert_eq!(told["repairs"].get("faces_crossing_themselves"), None);
    assert!(
        (0.72..0.78).contains(&(holed as f64 / full as f64)),
        "{holed} of {full}"
    );
    // Two walls of a room with a corner in each straight stretch.
    let room = [
        [0.0, 0.0],
        [2.0, 0.0],
        [4.0, 0.0],
        [4.0, 1.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [1.0, 4.0],
        [0.0, 4.0],
        [0.0, 2.0],
    ];
    let (told, room) = area(&room, 0.0);
    assert_eq!(told["leaf_triangles"], 8, "{told}");
    assert!(
        (0.40..0.475).contains(&(room as f64 / full as f64)),
        "{room} of {full}"
    );
    let bow = [[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 3.0]];
    let (told, _) = area(&bow, 0.0);
    assert_eq!(told["repairs"]["faces_crossing_themselves"], 1, "{told}");
    let remark = told["remarks"][0].as_str().unwrap();
    assert!(
        remark.contains("crosses itself") && remark.contains("at ["),
        "{remark}"
    );
}
