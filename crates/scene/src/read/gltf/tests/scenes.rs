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
    made.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    made.json["meshes"][0]["name"] = json!("tree");
    made.json["nodes"] = json!([
        {"mesh": 0, "name": "first"},
        {"mesh": 0, "translation": [5, 0, 0]},
        {"mesh": 1},
    ]);
    let mesh = made.json["meshes"][0]["primitives"].clone();
    made.push("meshes", json!({"primitives": mesh}));
    let scene = scene(&made);
    let names: Vec<&str> = scene
        .objects
        .iter()
        .map(|object| object.name.as_str())
        .collect();
    assert_eq!(names, ["tree", "a 1"]);
    let placements = &scene.objects[0].placements;
    assert_eq!(placements.len(), 2);
    assert_eq!(at(&placements[1], [0.0; 3]), DVec3::new(5.0, 0.0, 0.0));
    assert_eq!(scene.meshes.len(), 2);
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
    made.json["extensionsUsed"] = json!(["KHR_materials_unlit", "EXT_mesh_gpu_instancing"]);
    made.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    let said = [
        "shapes that morph are shown at rest",
        "animations are not played",
        "extensions that are not drawn: EXT_mesh_gpu_instancing",
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
