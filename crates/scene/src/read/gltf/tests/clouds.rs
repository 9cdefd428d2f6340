//! Do the points of a glTF file become clouds?

use super::made::{F32, Made, U8};
use super::scene;
use serde_json::json;

const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 4.0, -1.0]];

#[test]
fn points_become_a_cloud_beside_the_mesh_that_has_them() {
    let mut made = Made::square();
    let positions = made.positions(&CORNERS);
    let light: Vec<u8> = [[1.0_f32, 0.0, 0.5]; 3]
        .as_flattened()
        .iter()
        .flat_map(|it| it.to_le_bytes())
        .collect();
    let colours = made.accessor(F32, "VEC3", 3, &light);
    let indices = made.accessor(U8, "SCALAR", 2, &[2, 0]);
    made.primitive(json!({
        "attributes": {"POSITION": positions, "COLOR_0": colours},
        "indices": indices,
        "mode": 0
    }));
    made.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]);
    made.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = scene(&made);
    assert_eq!((scene.objects.len(), scene.clouds.len()), (1, 1));
    assert_eq!(scene.meshes[0].positions.len(), 4);
    let cloud = &scene.clouds[0];
    assert_eq!(cloud.placements.len(), 2);
    assert_eq!(cloud.placements[1].translation.x, 5.0);
    let at = |point: usize, k: usize| {
        f64::from(cloud.places[point][k]) * cloud.scale[k] + cloud.offset[k]
    };
    assert_eq!([0, 1, 2].map(|k| at(0, k)), [0.0, 4.0, -1.0]);
    assert_eq!([0, 1, 2].map(|k| at(1, k)), [0.0; 3]);
    assert_eq!(cloud.colours[0], [65_535, 0, 188 * 257]);
}

#[test]
fn points_alone_are_a_scene() {
    let mut made = Made::empty();
    let positions = made.positions(&CORNERS);
    made.primitive(json!({"attributes": {"POSITION": positions}, "mode": 0}));
    let scene = scene(&made);
    assert!(scene.meshes[0].triangles.is_empty() && scene.clouds[0].colours.is_empty());
    assert_eq!(scene.clouds[0].places.len(), 3);
}
