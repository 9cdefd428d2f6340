//! Are colours shown that files store in numbers of an odd kind or size?

use super::row::{Row, png_of};
use crate::support::Folder;

/// What all of them should show.
const COLOUR: [u8; 3] = [200, 100, 50];

/// Rows of numbers as text; a PLY of a square with these properties besides x, y and z.
fn ply_square(kind: &str, colour: [f64; 3]) -> String {
    let [r, g, b] = colour;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
         property float z\nproperty {kind} red\nproperty {kind} green\nproperty {kind} blue\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    );
    for [x, y] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
        text += &format!("{x} {y} 0 {r} {g} {b}\n");
    }
    text + "4 0 1 2 3\n"
}

fn scaled(full: f64) -> [f64; 3] {
    COLOUR.map(|code| f64::from(code) * full / 255.0)
}

/// The same colour in linear light.
fn linear() -> [f64; 3] {
    COLOUR.map(|code| ((f64::from(code) / 255.0 + 0.055) / 1.055).powf(2.4))
}

/// A square as glTF, all in one file, with a colour of its vertices or a material.
fn gltf_square(accessor: &str, colours: &[u8], material: &str) -> String {
    use base64::Engine;
    let mut bytes: Vec<u8> = Vec::new();
    for place in [
        [0.0f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ] {
        bytes.extend(place.iter().flat_map(|it| it.to_le_bytes()));
    }
    bytes.extend([0, 1, 2, 0, 2, 3, 0, 0]);
    bytes.extend(colours);
    let all = bytes.len();
    let text = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let (attribute, accessor) = match accessor {
        "" => ("", String::new()),
        said => (
            r#","COLOR_0":2"#,
            format!(r#",{{"bufferView":2,"count":4,{said}}}"#),
        ),
    };
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{attribute}}},"indices":1,
        "material":0}}]}}],"materials":[{{{material}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}}{accessor}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},
        {{"buffer":0,"byteOffset":48,"byteLength":6}},
        {{"buffer":0,"byteOffset":56,"byteLength":{}}}],
        "buffers":[{{"byteLength":{all},"uri":"data:;base64,{text}"}}]}}"#,
        all - 56
    )
}

#[test]
fn colours_of_meshes_are_shown_whatever_kind_of_number_they_are() {
    let folder = Folder::new();
    let of_faces = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 2\nproperty list uchar int vertex_indices\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n\
        0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 200 100 50\n3 0 2 3 200 100 50\n";
    let obj = |full: f64| {
        let [r, g, b] = scaled(full);
        let vertex = |x, y| format!("v {x} {y} 0 {r} {g} {b}\n");
        vertex(0, 0) + &vertex(1, 0) + &vertex(1, 1) + &vertex(0, 1) + "f 1 2 3 4\n"
    };
    let codes = linear().map(|it| (it * 255.0).round() as u8);
    let linear = linear();
    let bytes = gltf_square(
        r#""componentType":5121,"type":"VEC3""#,
        &codes.repeat(4),
        "",
    );
    let [r, g, b] = linear;
    let gloss = format!(
        r#""doubleSided":true,"extensions":{{"KHR_materials_pbrSpecularGlossiness":
        {{"diffuseFactor":[{r},{g},{b},1]}}}}"#
    );
    let obj_black = "mtllib black.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
        vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    folder.holding("black.mtl", b"newmtl a\nKd 0 0 0\nmap_Kd flat.png\n");
    folder.holding("flat.png", &png_of(COLOUR, 4));
    let files: Vec<(&str, String)> = vec![
        ("uchar.ply", ply_square("uchar", scaled(255.0))),
        ("int.ply", ply_square("int", scaled(255.0))),
        ("uint.ply", ply_square("uint", scaled(255.0))),
        ("float.ply", ply_square("float", scaled(255.0))),
        ("double.ply", ply_square("double", scaled(255.0))),
        ("parts.ply", ply_square("float", scaled(1.0))),
        ("ushort.ply", ply_square("ushort", scaled(255.0))),
        (
            "twelve.ply",
            ply_square("ushort", scaled(4095.0).map(f64::round)),
        ),
        ("text.ply", ply_square("uchar", scaled(1.0))),
        ("faces.ply", of_faces.to_owned()),
        ("codes.obj", obj(255.0)),
        ("parts.obj", obj(1.0)),
        ("bytes.gltf", bytes),
        ("gloss.gltf", gltf_square("", &[], &gloss)),
        ("black.obj", obj_black.to_owned()),
    ];
    for (name, text) in &files {
        folder.holding(name, text.as_bytes());
    }
    let names: Vec<&str> = files.iter().map(|it| it.0).collect();
    let row = Row::of(&folder, &names);
    row.assert_alike(&names);
    row.assert_remarks(&["colours", "reach 255", "4294967295"]);
    row.assert_remarks(&["colours", "reach 4095", "65535"]);
    row.assert_remarks(&["whole numbers", "255 counts"]);
    row.assert_remarks(&["gloss is not drawn"]);
    assert_eq!(row.mended("colours_not_normalised"), 4);
    assert_eq!(row.mended("black_under_textures"), 1);
}

/// Where the points of a square lie.
fn points() -> Vec<[f64; 2]> {
    let all = (0..21).flat_map(|x| (0..21).map(move |y| [x, y]));
    all.map(|it| it.map(|along| f64::from(along) / 20.0))
        .collect()
}

/// A LAS 1.2 file of a square of points with these colours.
fn las(colour: impl Fn(usize) -> [u16; 3]) -> Vec<u8> {
    let points = points();
    let mut file = vec![0; 227];
    file[..4].copy_from_slice(b"LASF");
    file[24..26].copy_from_slice(&[1, 2]);
    file[94..96].copy_from_slice(&227u16.to_le_bytes());
    file[96..100].copy_from_slice(&227u32.to_le_bytes());
    file[104] = 2;
    file[105..107].copy_from_slice(&26u16.to_le_bytes());
    file[107..111].copy_from_slice(&(points.len() as u32).to_le_bytes());
    for at in [131, 139, 147] {
        file[at..at + 8].copy_from_slice(&0.001f64.to_le_bytes());
    }
    for (number, [x, y]) in points.iter().enumerate() {
        for along in [*x, *y, 0.0] {
            file.extend(((along * 1000.0) as i32).to_le_bytes());
        }
        file.extend([0; 8]);
        file.extend(colour(number).iter().flat_map(|it| it.to_le_bytes()));
    }
    file
}

fn ply_points(kind: &str, names: [&str; 3], colour: [f64; 3]) -> String {
    let [r, g, b] = colour;
    let [red, green, blue] = names;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex 441\nproperty float x\nproperty float y\n\
         property float z\nproperty {kind} {red}\nproperty {kind} {green}\nproperty {kind} {blue}\n\
         end_header\n"
    );
    for [x, y] in points() {
        text += &format!("{x} {y} 0 {r} {g} {b}\n");
    }
    text
}

#[test]
fn colours_of_points_are_shown_whatever_their_depth() {
    let folder = Folder::new();
    const RGB: [&str; 3] = ["red", "green", "blue"];
    let codes = |times: u16| COLOUR.map(|it| u16::from(it) * times);
    let stray = |at: usize| if at == 3 { codes(257) } else { codes(1) };
    let splat = scaled(1.0).map(|it| (it - 0.5) / 0.282_094_79);
    let twelve = scaled(4095.0).map(|it| it.round() as u16);
    let files: Vec<(&str, Vec<u8>)> = vec![
        ("eight.las", las(|_| codes(1))),
        ("stray.las", las(stray)),
        ("twelve.las", las(|_| twelve)),
        ("sixteen.las", las(|_| codes(257))),
        ("times.las", las(|_| codes(256))),
        ("uchar.ply", ply_points("uchar", RGB, scaled(255.0)).into()),
        ("float.ply", ply_points("float", RGB, scaled(255.0)).into()),
        (
            "capitals.ply",
            ply_points("uchar", ["Red", "Green", "Blue"], scaled(255.0)).into(),
        ),
        (
            "splats.ply",
            ply_points("float", ["f_dc_0", "f_dc_1", "f_dc_2"], splat).into(),
        ),
    ];
    for (name, bytes) in &files {
        folder.holding(name, bytes);
    }
    let names: Vec<&str> = files.iter().map(|it| it.0).collect();
    let row = Row::of(&folder, &names);
    row.assert_alike(&names);
    row.assert_remarks(&["splats are drawn as points"]);
    row.assert_remarks(&["1 of them are beyond", "16 bits"]);
    row.assert_remarks(&["reach 4095"]);
    assert_eq!(row.mended("colours_of_another_depth"), 1);
}
