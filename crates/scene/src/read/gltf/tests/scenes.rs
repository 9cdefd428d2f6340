//! Do nodes, buffers and names become the right objects?

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DAffine3, DVec3};
use serde_json::json;

use super::super::super::SceneFormat;
use super::super::super::files::{Files, Nowhere};
use super::super::super::mangle::cut_and_flip;
use super::super::read;
use super::made::{F32, Made, f32_bytes};
use super::scene;

fn at(world_from_mesh: &DAffine3, point: [f64; 3]) -> DVec3 {
    world_from_mesh.transform_point3(DVec3::from_array(point))
}

#[test]
fn nodes_stand_where_their_parents_put_them() {
    let mut made = Made::square();
    made.json["scene"] = json!(1);
    made.json["scenes"] = json!([{"nodes": []}, {"nodes": [2]}]);
    let half = 0.5f64.sqrt();
    made.json["nodes"] = json!([
        {"mesh": 0, "scale": [2, 2, 2]},
        {"children": [0], "rotation": [0, 0, half, half]},
        {"children": [1], "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 10000000.001,0,0,1]},
        {"mesh": 0},
    ]);
    let scene = scene(&made);
    assert_eq!(scene.objects.len(), 1);
    let stands = at(&scene.objects[0].placements[0], [1.0, 0.0, 0.0]);
    let wanted = DVec3::new(10_000_000.001, 2.0, 0.0);
    assert!(stands.distance(wanted) < 1e-8, "{stands}");
}

#[test]
fn nodes_with_one_mesh_are_placements_of_one_object() {
    let mut made = Made::square();
    made.json["scenes"] = json!([{"nodes": [0, 1, 2, 3]}]);
    made.json["meshes"][0]["name"] = json!("tree");
    made.json["nodes"] = json!([
        {"mesh": 0, "name": "first"},
        {"mesh": 0, "translation": [5, 0, 0]},
        {"mesh": 1},
        {"mesh": 2, "translation": [0, 7, 0]},
    ]);
    let mesh = made.json["meshes"][0]["primitives"].clone();
    made.push("meshes", json!({"primitives": mesh, "weights": [0.5]}));
    // What says the same is the same, whatever it is called.
    made.push(
        "meshes",
        json!({"primitives": mesh, "name": "another tree"}),
    );
    let scene = scene(&made);
    let names: Vec<&str> = scene
        .objects
        .iter()
        .map(|object| object.name.as_str())
        .collect();
    assert_eq!(names, ["tree", "a 1"]);
    let placements = &scene.objects[0].placements;
    assert_eq!(placements.len(), 3);
    assert_eq!(at(&placements[1], [0.0; 3]), DVec3::new(5.0, 0.0, 0.0));
    assert_eq!(at(&placements[2], [0.0; 3]), DVec3::new(0.0, 7.0, 0.0));
    assert_eq!(scene.meshes.len(), 2);
}

/// A square with three instances, turned and scaled.
fn instanced() -> Made {
    let mut made = Made::square();
    made.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let translations = made.positions(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
    // A quarter and half a turn about z, in normalised 16-bit numbers.
    let turns: [[i16; 4]; 3] = [[0, 0, 0, 32767], [0, 0, 23170, 23170], [0, 0, 32767, 0]];
    let bytes: Vec<u8> = turns
        .iter()
        .flatten()
        .flat_map(|it| it.to_le_bytes())
        .collect();
    let rotations = made.accessor(5122, "VEC4", 3, &bytes);
    made.json["accessors"][rotations]["normalized"] = json!(true);
    made.json["nodes"][0] = json!({
        "mesh": 0, "translation": [0, 10, 0],
        "extensions": {"EXT_mesh_gpu_instancing": {
            "attributes": {"TRANSLATION": translations, "ROTATION": rotations, "_ID": 77},
        }},
    });
    made
}

#[test]
fn instances_stand_where_their_node_and_accessors_put_them() {
    let scene = scene(&instanced());
    let placements = &scene.objects[0].placements;
    let corners: Vec<DVec3> = placements
        .iter()
        .map(|it| at(it, [1.0, 0.0, 0.0]))
        .collect();
    let wanted = [[2.0, 10.0, 0.0], [2.0, 11.0, 0.0], [2.0, 10.0, 0.0]];
    for (found, wanted) in corners.iter().zip(wanted) {
        assert!(found.distance(DVec3::from_array(wanted)) < 1e-4, "{found}");
    }
    assert_eq!(corners.len(), 3);
    assert_eq!(scene.objects.len(), 1);
}

#[test]
fn instances_that_differ_in_number_are_left_out_and_such_without_end_refused() {
    let mut made = instanced();
    made.json["accessors"][3]["count"] = json!(2);
    let once = scene(&made);
    assert_eq!(once.objects[0].placements.len(), 1);
    let said = &once.remarks[0];
    assert!(said.contains("node 0: its instances have [3, 2]"), "{said}");
    let mut made = instanced();
    let node = made.json["nodes"][0].clone();
    made.json["nodes"] = json!(vec![node; 90_000]);
    made.json["scenes"][0]["nodes"] = json!((0..90_000).collect::<Vec<u32>>());
    let said = super::refusal(&made.glb());
    assert!(said.contains("more than 262144 places"), "{said}");
}

#[test]
fn shapes_that_morph_are_as_at_rest_also_where_they_are_sparse() {
    let mut made = Made::square();
    let steps = made.positions(&[[0.0; 3]; 4]);
    made.json["accessors"][steps]
        .as_object_mut()
        .unwrap()
        .remove("bufferView");
    let places = made.view(&[2]);
    let values = made.view(&f32_bytes(&[0.0, 0.0, 4.0]));
    made.json["accessors"][steps]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": places, "componentType": 5121},
        "values": {"bufferView": values},
    });
    made.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": steps}]);
    let height = |made: &Made| scene(made).meshes[0].positions[2].z;
    assert_eq!(height(&made), 0.0);
    made.json["meshes"][0]["weights"] = json!([0.5]);
    assert_eq!(height(&made), 2.0);
    made.json["accessors"][steps]["count"] = json!(3);
    assert_eq!(height(&made), 0.0);
    assert_eq!(scene(&made).repairs["shapes_left_out"], 1);
}

#[test]
fn without_scenes_all_roots_are_shown() {
    let mut made = Made::square();
    made.json["scenes"] = json!([]);
    made.json["nodes"] = json!([{"mesh": 0}, {"children": [0], "translation": [0, 3, 0]}]);
    let scene = scene(&made);
    let placements = &scene.objects[0].placements;
    assert_eq!(placements.len(), 1);
    assert_eq!(at(&placements[0], [0.0; 3]), DVec3::new(0.0, 3.0, 0.0));
}

#[test]
fn a_skin_at_rest_stands_where_its_first_joint_carries_it() {
    let mut made = Made::square();
    let inverse = [
        1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., -1., 0., 0., 1.,
    ];
    let matrices = made.accessor(F32, "MAT4", 1, &f32_bytes(&inverse));
    made.json["skins"] = json!([{"inverseBindMatrices": matrices, "joints": [1]}]);
    made.json["scenes"] = json!([{"nodes": [0, 1]}]);
    made.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [9, 9, 9]},
        {"translation": [1, 2, 0]},
    ]);
    let scene = scene(&made);
    let stands = at(&scene.objects[0].placements[0], [0.0; 3]);
    assert_eq!(stands, DVec3::new(0.0, 2.0, 0.0));
    assert_eq!(scene.remarks, ["skins are shown at rest"]);
}

#[test]
fn what_is_not_drawn_is_said() {
    let mut made = Made::square();
    made.json["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    made.json["animations"] = json!([{}]);
    made.json["extensionsUsed"] = json!(["KHR_materials_unlit", "EXT_odd"]);
    made.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    let said = [
        "shapes that morph are shown at rest",
        "animations are not played",
        "extensions that are not drawn: EXT_odd",
    ];
    assert_eq!(scene(&made).remarks, said);
}

#[test]
fn buffers_may_be_inline_beside_the_file_or_in_it() {
    let made = Made::square();
    let inline = STANDARD.encode(&made.binary);
    let inline = format!("data:application/octet-stream;base64,{inline}");
    let mut files = Files(BTreeMap::from([("b/a b.bin", made.binary.clone())]));
    let beside = read(&made.gltf("b/a%20b.bin"), "a", &mut files).unwrap();
    let inline = read(&made.gltf(&inline), "a", &mut Nowhere).unwrap();
    let within = scene(&made);
    for scene in [&beside, &inline] {
        assert_eq!(scene.meshes[0].positions, within.meshes[0].positions);
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    }
}

#[test]
fn no_cut_and_no_flip_of_a_byte_panics() {
    let made = Made::square();
    cut_and_flip(SceneFormat::Gltf, &made.glb());
    let inline = format!("data:;base64,{}", STANDARD.encode(&made.binary));
    cut_and_flip(SceneFormat::Gltf, &made.gltf(&inline));
}

#[test]
fn a_buffer_shorter_than_said_shows_what_is_there() {
    let mut made = Made::square();
    made.json["buffers"][0]["byteLength"] = json!(1000);
    let scene = scene(&made);
    assert_eq!(scene.meshes[0].triangles.len(), 2);
    assert_eq!(scene.repairs["short_buffers"], 1);
}
