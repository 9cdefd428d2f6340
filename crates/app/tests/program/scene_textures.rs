//! Does a textured mesh go from its files to the picture that an eye gets, with its textures?

use crate::support::{Folder, Ran, Rgb, command, finish, glb, json};
use serde_json::{Value, json as json_of};
use std::f64::consts::{PI, TAU};

/// Sides of the sphere's net: columns and rows of squares.
const NET: [u32; 2] = [48, 24];

/// Blue at the left, a narrow column of green, red at the right, with waves from top to bottom.
fn picture(size: [u32; 2]) -> Vec<u8> {
    let [columns, rows] = size;
    let texel = |column: u32, row: u32| {
        let wave = 200 + (40.0 * (f64::from(row) / 3.0).sin()) as u32;
        let turned = 20 * column / columns;
        let strong = if turned < 9 {
            2
        } else {
            usize::from(turned < 11)
        };
        core::array::from_fn::<u8, 3, _>(|k| if k == strong { wave as u8 } else { 12 })
    };
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| texel(column, row)));
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(all.collect::<Vec<_>>().as_flattened())
        .unwrap();
    drop(writer);
    bytes
}

/// Place and texture place of every corner of the net: its seam has corners twice.
fn corners() -> Vec<([f64; 3], [f64; 2])> {
    let [columns, rows] = NET;
    let corner = |row: u32, column: u32| {
        let [u, v] = [(column, columns), (row, rows)].map(|(n, of)| f64::from(n) / f64::from(of));
        let turn = TAU * f64::from(column % columns) / f64::from(columns);
        let ring = if row.is_multiple_of(rows) {
            0.0
        } else {
            (PI * v).sin()
        };
        // The middle of the picture looks to +z.
        (
            [-ring * turn.sin(), (PI * v).cos(), -ring * turn.cos()],
            [u, v],
        )
    };
    (0..=rows)
        .flat_map(|row| (0..=columns).map(move |column| corner(row, column)))
        .collect()
}

fn triangles() -> Vec<[u32; 3]> {
    let [columns, rows] = NET;
    let at = |row: u32, column: u32| row * (columns + 1) + column;
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    cells
        .flat_map(|(row, column)| {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            // At a pole two corners of a square are one.
            let upper = (row > 0).then_some([a, c, b]);
            let lower = (row + 1 < rows).then_some([b, c, d]);
            upper.into_iter().chain(lower)
        })
        .collect()
}

/// A sphere whose picture lies in the same file.
fn sphere_glb(image: &[u8]) -> Vec<u8> {
    let mut binary = Vec::new();
    let mut views = Vec::new();
    let mut view = |bytes: &[u8]| {
        views.push(json_of!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        binary.extend(bytes);
        while binary.len() % 4 > 0 {
            binary.push(0);
        }
    };
    let floats = |all: Vec<f64>| -> Vec<u8> {
        all.iter()
            .flat_map(|it| (*it as f32).to_le_bytes())
            .collect()
    };
    view(&floats(
        corners().iter().flat_map(|(place, _)| *place).collect(),
    ));
    view(&floats(corners().iter().flat_map(|(_, uv)| *uv).collect()));
    let numbers = triangles();
    view(
        &numbers
            .as_flattened()
            .iter()
            .flat_map(|it| it.to_le_bytes())
            .collect::<Vec<u8>>(),
    );
    view(image);
    let count = corners().len();
    let document = json_of!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "ball"}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 1},
            "indices": 2, "material": 0,
        }]}],
        "materials": [{
            "extensions": {"KHR_materials_unlit": {}},
            "normalTexture": {"index": 0},
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        }],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapT": 33071}],
        "images": [{"bufferView": 3, "mimeType": "image/png", "name": "thirds"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
             "min": [-1, -1, -1], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5125, "count": 3 * numbers.len(), "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": binary.len()}],
    });
    glb(&document, &binary)
}

/// The same sphere as OBJ, whose MTL names a picture next to it.
fn sphere_obj() -> String {
    let mut text = "mtllib ball.mtl\nusemtl thirds\n".to_owned();
    for ([x, y, z], [u, v]) in corners() {
        text += &format!("v {x} {y} {z}\nvt {u} {}\n", 1.0 - v);
    }
    for corners in triangles() {
        let [a, b, c] = corners.map(|it| it + 1);
        text += &format!("f {a}/{a} {b}/{b} {c}/{c}\n");
    }
    text
}

fn simulate(folder: &Folder, pack: &str, more: &[&str]) -> Value {
    let out = folder.name("out");
    let mut arguments = vec!["simulate", pack, "--out", &out, "--gaze", "0,0"];
    arguments.extend(["--view", "240x240", "--fov", "60", "--renderer", "cpu"]);
    arguments.extend(more);
    json(&arguments)
}

/// Which of red, green and blue are strong at the left, in the middle and at the right.
fn thirds(folder: &Folder) -> [[bool; 3]; 3] {
    let picture = Rgb::read(&folder.name("out/frame_00000.png"));
    [60, 120, 180].map(|x| picture.at([x, 120]).map(|code| code > 100))
}

#[test]
fn a_textured_sphere_is_prepared_verified_chosen_and_drawn() {
    let folder = Folder::new();
    let source = folder.holding("ball.glb", &sphere_glb(&picture([1500, 700])));
    let pack = folder.name("ball.foveal");
    let done = json(&["prepare", "scene", &source, "--out", &pack]);
    assert_eq!(done["texels"], 1500 * 700, "{done}");
    assert_eq!(
        done["remarks"],
        json_of!(["normal maps are not drawn: 1 material"])
    );
    let bytes = |kind: &str| done["bytes_by_kind"][kind].as_u64().unwrap();
    assert!(bytes("texture") > 10_000 && bytes("mesh") > 5_000, "{done}");
    let tried = json(&["verify", &pack, "--cuts", "10", "--orders", "5"]);
    assert_eq!(
        (&tried["ok"], &tried["odd_edges_max"]),
        (&true.into(), &0.into()),
        "{tried}"
    );
    let still = |policy| {
        let run = simulate(&folder, &pack, &["--policy", policy, "--frames", "1"]);
        (run, thirds(&folder))
    };
    let [(full, sharp), (coarsest, coarse), (acuity, chosen)] =
        ["full", "coarsest", "acuity"].map(still);
    // From its front: a part of blue, green in the middle, a part of red.
    let expected = [
        [false, false, true],
        [false, true, false],
        [true, false, false],
    ];
    assert_eq!([sharp, coarse, chosen], [expected; 3]);
    assert_eq!(full["error_all"], 0.0);
    let all = [&coarsest, &acuity, &full].map(|run| run["bytes"].as_u64().unwrap());
    assert!(all.is_sorted() && 5 * all[1] < 4 * all[2], "{all:?}");
    assert!(acuity["error_fovea"].as_f64() < coarsest["error_fovea"].as_f64());
    assert!(acuity["bytes_by_kind"]["texture"].as_u64().unwrap() > 0);
    let link = [
        "--policy",
        "eccentricity",
        "--budget",
        "10KB",
        "--interval",
        "100ms",
    ];
    let run = simulate(
        &folder,
        &pack,
        &[
            &link[..],
            &["--frames", "12", "--pictures", "none", "--score"],
        ]
        .concat(),
    );
    assert!(
        run["error_fovea"].as_f64() < coarsest["error_fovea"].as_f64(),
        "{run}"
    );
    assert!(run["score"].is_object(), "{run}");
}

#[test]
fn what_has_no_room_on_the_gpu_is_no_damage() {
    let folder = Folder::new();
    let source = folder.holding("ball.glb", &sphere_glb(&picture([1500, 700])));
    let pack = folder.name("ball.foveal");
    json(&["prepare", "scene", &source, "--out", &pack]);
    let with = |memory: &str| {
        let out = folder.name("out");
        let run = ["simulate", &pack, "--out", &out, "--gaze", "0,0"];
        let of = ["--view", "640x480", "--frames", "1", "--gpu-memory", memory];
        json(&[&run[..], &of].concat())
    };
    let [little, enough] = ["1MB", "64MB"].map(with);
    assert!(little["units_without_room"].as_u64() > Some(0), "{little}");
    assert_eq!(enough["units_without_room"], 0, "{enough}");
    for run in [little, enough] {
        assert_eq!(run["damaged_units"], 0, "{run}");
    }
}

#[test]
fn an_obj_has_the_picture_that_its_materials_name_and_a_missing_one_leaves_the_colour() {
    let folder = Folder::new();
    let source = folder.holding("ball.obj", sphere_obj().as_bytes());
    folder.holding(
        "ball.mtl",
        b"newmtl thirds\nKd 1 1 1\nmap_Kd -s 1 1 a picture.png\n",
    );
    folder.holding("a picture.png", &picture([600, 300]));
    let pack = folder.name("ball.foveal");
    let done = json(&["prepare", "scene", &source, "--out", &pack, "--exact"]);
    assert_eq!(
        (&done["texels"], &done["repairs"]),
        (&180_000.into(), &json_of!({"unused_vertices": 2})),
        "{done}"
    );
    simulate(&folder, &pack, &["--policy", "full", "--frames", "1"]);
    let shown = thirds(&folder);
    assert_eq!(
        shown,
        [
            [false, false, true],
            [false, true, false],
            [true, false, false]
        ]
    );
    std::fs::remove_file(folder.name("a picture.png")).unwrap();
    let done = json(&["prepare", "scene", &source, "--out", &pack, "--force"]);
    assert_eq!(
        (&done["texels"], &done["repairs"]["missing_images"]),
        (&0.into(), &1.into())
    );
    simulate(&folder, &pack, &["--policy", "full", "--frames", "1"]);
    assert_eq!(thirds(&folder)[1], [true; 3], "white");
}

#[test]
fn every_flipped_byte_of_a_textured_scene_is_found() {
    let folder = Folder::new();
    let source = folder.holding("ball.glb", &sphere_glb(&picture([300, 200])));
    let pack = folder.name("ball.foveal");
    json(&["prepare", "scene", &source, "--out", &pack]);
    let good = std::fs::read(&pack).unwrap();
    for place in (0..good.len()).step_by(good.len() / 40) {
        let mut bad = good.clone();
        bad[place] ^= 0x20;
        std::fs::write(&pack, &bad).unwrap();
        let Ran { code, stderr, .. } = finish(command(&["verify", &pack]));
        assert!(
            code == Some(1) && !stderr.contains("panicked"),
            "byte {place}: {stderr}"
        );
    }
}
