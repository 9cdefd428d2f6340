//! Do accessors and primitives become the right triangles?

use glam::DVec3;
use serde_json::json;

use super::super::super::files::Nowhere;
use super::super::super::single::SceneFile;
use super::super::super::{SceneFormat, Up};
use super::made::{F32, Made, SQUARE, U8, U16, f32_bytes};
use super::scene;

/// The triangles of four vertices without indices in a mode.
fn triangles_in(mode: u32) -> (Vec<[u32; 3]>, crate::source::Repairs) {
    let mut made = Made::empty();
    let positions = made.positions(&SQUARE);
    made.primitive(json!({"attributes": {"POSITION": positions}, "mode": mode}));
    let scene = scene(&made);
    (scene.meshes[0].triangles.clone(), scene.repairs)
}

#[test]
fn strips_and_fans_become_triangles_that_face_one_way() {
    assert_eq!(triangles_in(5).0, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(triangles_in(6).0, [[1, 2, 0], [2, 3, 0]]);
}

#[test]
fn points_lines_and_left_over_corners_are_counted() {
    for (mode, name, times) in [
        (1, "lines_left_out", 2),
        (2, "lines_left_out", 4),
        (3, "lines_left_out", 3),
        (4, "corners_left_out", 1),
    ] {
        assert_eq!(triangles_in(mode).1[name], times, "mode {mode}");
    }
}

#[test]
fn parts_become_one_mesh_and_share_vertices_of_the_same_accessors() {
    let mut made = Made::square();
    made.json["materials"] = json!([
        {"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}},
        {"name": "lamp", "alphaMode": "BLEND", "doubleSided": true,
         "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 0, 0.5]},
         "extensions": {"KHR_materials_unlit": {}}},
    ]);
    let indices = made.accessor(U16, "SCALAR", 3, &[3, 0, 2, 0, 0, 0]);
    let attributes = json!({"POSITION": 0});
    made.primitive(json!({"attributes": attributes, "indices": indices, "material": 0}));
    made.primitive(json!({"attributes": attributes, "indices": indices, "material": 1}));
    let scene = scene(&made);
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 0], [7, 6, 4]]);
    // The part without a material has one more than the file.
    assert_eq!(mesh.materials, [2, 2, 0, 1]);
    assert_eq!(scene.materials.len(), 3);
    assert_eq!(scene.materials[0].colour, [1.0, 0.0, 0.0, 1.0]);
    let lamp = &scene.materials[1];
    assert_eq!(lamp.colour, [1.0, 1.0, 0.0, 0.5]);
    assert!(lamp.unlit && lamp.two_sided);
}

#[test]
fn normals_and_colours_are_filled_where_a_part_has_none() {
    let mut made = Made::square();
    let positions = made.positions(&SQUARE.map(|[x, y, _]| [x, y, 1.0]));
    let normals = made.positions(&[[0.0, 0.0, 1.0]; 4]);
    let colours = made.accessor(U8, "VEC4", 4, &[255, 0, 51, 51].repeat(4));
    made.json["accessors"][colours]["normalized"] = json!(true);
    let indices = made.accessor(U8, "SCALAR", 3, &[0, 1, 2]);
    made.primitive(json!({
        "attributes": {"POSITION": positions, "NORMAL": normals, "COLOR_0": colours},
        "indices": indices
    }));
    let mesh = &scene(&made).meshes[0];
    assert_eq!(mesh.normals[0], [0.0; 3]);
    assert_eq!(mesh.normals[4], [0.0, 0.0, 1.0]);
    assert_eq!(mesh.colours[0], [1.0; 4]);
    // Without a material a surface is opaque.
    assert_eq!(mesh.colours[4], [1.0, 0.0, 0.2, 1.0]);
}

#[test]
fn quantised_positions_are_read_with_their_strides() {
    let mut made = Made::empty();
    made.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let wanted: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    let kinds: [(u32, Vec<u8>, f64); 4] = [
        (5120, vec![0, 0, 0, 9, 127, 0, 0, 9, 0, 128, 0, 9], 127.0),
        (U8, vec![0, 0, 0, 9, 255, 0, 0, 9, 0, 0, 255, 9], 255.0),
        (
            5122,
            [0i16, 0, 0, 9, 32767, 0, 0, 9, 0, -32768, 0, 9]
                .map(i16::to_le_bytes)
                .concat(),
            32767.0,
        ),
        (
            U16,
            [0u16, 0, 0, 9, 65535, 0, 0, 9, 0, 0, 65535, 9]
                .map(u16::to_le_bytes)
                .concat(),
            65535.0,
        ),
    ];
    for (kind, bytes, full) in kinds {
        for normalised in [true, false] {
            let mut made = Made {
                json: made.json.clone(),
                binary: Vec::new(),
            };
            let positions = made.accessor(kind, "VEC3", 3, &bytes);
            made.json["accessors"][positions]["normalized"] = json!(normalised);
            made.json["bufferViews"][0]["byteStride"] = json!(bytes.len() / 3);
            made.primitive(json!({"attributes": {"POSITION": positions}}));
            let read = &scene(&made).meshes[0].positions;
            let full = if normalised { 1.0 } else { full };
            assert_eq!(read[1], DVec3::from_array(wanted[1]) * full);
            assert!(normalised || read[2].abs().max_element() >= full);
            assert!(!normalised || read[2].abs().max_element() == 1.0);
        }
    }
}

#[test]
fn sparse_elements_replace_those_of_a_view_or_of_none() {
    for based in [true, false] {
        let mut made = Made::empty();
        let positions = made.positions(&SQUARE);
        if !based {
            made.json["accessors"][positions]
                .as_object_mut()
                .unwrap()
                .remove("bufferView");
        }
        let at = made.view(&[1, 3]);
        let values = made.view(&f32_bytes(&[5.0, 0.0, 0.0, 0.0, 6.0, 0.0]));
        made.json["accessors"][positions]["sparse"] = json!({
            "count": 2,
            "indices": {"bufferView": at, "componentType": U8},
            "values": {"bufferView": values},
        });
        let indices = made.accessor(U8, "SCALAR", 3, &[2, 3, 1]);
        made.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
        let corner = if based {
            DVec3::new(1.0, 1.0, 0.0)
        } else {
            DVec3::ZERO
        };
        let read = &scene(&made).meshes[0].positions;
        assert_eq!(read[1], DVec3::new(5.0, 0.0, 0.0));
        assert_eq!(read[3], DVec3::new(0.0, 6.0, 0.0));
        assert_eq!(read[2], corner);
    }
}

#[test]
fn two_accessors_may_share_a_view_in_turns() {
    let mut made = Made::empty();
    let rows: Vec<f32> = SQUARE
        .iter()
        .flat_map(|at| [at[0], at[1], at[2], 0.0, 0.0, 1.0])
        .collect();
    let positions = made.accessor(F32, "VEC3", 4, &f32_bytes(&rows));
    made.json["bufferViews"][0]["byteStride"] = json!(24);
    let mut normals = made.json["accessors"][0].clone();
    normals["byteOffset"] = json!(12);
    let normals = made.push("accessors", normals);
    let attributes = json!({"POSITION": positions, "NORMAL": normals});
    made.primitive(json!({"attributes": attributes, "mode": 5}));
    let mesh = &scene(&made).meshes[0];
    assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 4]);
}

/// A file as the whole reader reads it, with what it leaves out.
fn whole(made: &Made) -> crate::source::SourceScene {
    let bytes = made.glb();
    let file = SceneFile {
        name: "a",
        format: SceneFormat::Gltf,
        up: Up::Y,
        bytes: &bytes,
    };
    file.read(&mut Nowhere).unwrap()
}

#[test]
fn corners_that_are_not_there_or_nowhere_cost_their_triangles() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut made = Made::empty();
        let [a, b, c, d] = SQUARE;
        let positions = made.positions(&[a, b, c, d, [bad, 0.0, 0.0]]);
        let corners = [0, 1, 2, 0, 2, 3, 0, 1, 4, 0, 1, 5];
        let indices = made.accessor(U8, "SCALAR", 12, &corners);
        let uvs = [[0.0, 0.0], [bad, 0.0], [1.0, 1.0], [0.0, 1.0], [bad; 2]];
        let uvs = made.accessor(F32, "VEC2", 5, &f32_bytes(uvs.as_flattened()));
        let colours = made.accessor(F32, "VEC3", 5, &f32_bytes(&[f32::NAN; 15]));
        made.json["materials"] = json!([
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
        ]);
        made.json["textures"] = json!([{"source": 0}]);
        made.json["images"] = json!([{"uri": "none.png"}]);
        made.primitive(json!({
            "attributes": {"POSITION": positions, "TEXCOORD_0": uvs, "COLOR_0": colours},
            "indices": indices, "material": 0,
        }));
        let scene = whole(&made);
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(scene.meshes[0].colours, [[1.0; 4]; 4]);
        let all = [
            ("triangles_without_place", 1),
            ("triangles_out_of_range", 1),
            ("uvs_made", 1),
            ("colours_made", 5),
        ];
        for (name, times) in all {
            assert_eq!(scene.repairs[name], times, "{name}");
        }
    }
}

#[test]
fn a_fan_that_turns_back_over_itself_is_filled_as_an_outline() {
    let mut made = Made::empty();
    // An arrow, and a fan round its tip.
    let arrow = [
        [2.0, 0.0, 0.0],
        [3.0, 2.0, 0.0],
        [0.0, 0.0, 0.0],
        [3.0, -2.0, 0.0],
    ];
    let arrow = [arrow[1], arrow[2], arrow[3], arrow[0]];
    let positions = made.positions(&arrow);
    made.primitive(json!({"attributes": {"POSITION": positions}, "mode": 6}));
    let scene = whole(&made);
    assert_eq!(scene.repairs["concave_fans_filled"], 1);
    let mesh = &scene.meshes[0];
    let area = |it: &[u32; 3]| {
        let [a, b, c] = it.map(|at| mesh.positions[at as usize]);
        (b - a).cross(c - a).z / 2.0
    };
    assert!((mesh.triangles.iter().map(area).sum::<f64>() - 4.0).abs() < 1e-9);
    assert!(mesh.triangles.iter().all(|it| area(it) > 0.0));
}
