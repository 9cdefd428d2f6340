//! Do materials have the pictures that the file names, and lie as it says?

use std::collections::BTreeMap;

use foveal_core::content::images::wrap::Wrap;
use glam::DVec2;
use serde_json::json;

use super::super::super::files::{Files, Nowhere};
use super::super::read;
use super::made::{F32, Made, f32_bytes};
use super::scene;
use crate::source::SourceScene;

const UVS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

/// A square whose material has this base colour texture, out of `textures`.
fn square(texture: serde_json::Value) -> Made {
    let mut made = Made::square();
    let first = made.accessor(F32, "VEC2", 4, &f32_bytes(UVS.as_flattened()));
    let moved = UVS.map(|uv| uv.map(|it| it + 5.0));
    let second = made.accessor(F32, "VEC2", 4, &f32_bytes(moved.as_flattened()));
    let part = &mut made.json["meshes"][0]["primitives"][0];
    part["attributes"]["TEXCOORD_0"] = json!(first);
    part["attributes"]["TEXCOORD_1"] = json!(second);
    part["material"] = json!(0);
    made.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": texture}}]);
    let view = made.view(b"bytes of a picture");
    made.json["images"] = json!([{"bufferView": view}, {"uri": "b/a%20b.png"}]);
    made.json["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 1}, {"source": 7}, {}]);
    made.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    made
}

fn read_beside(made: &Made) -> SourceScene {
    let files = [
        ("b/a b.png", b"nearby".to_vec()),
        ("all.bin", made.binary.clone()),
    ];
    read(
        &made.gltf("all.bin"),
        "a",
        &mut Files(BTreeMap::from(files)),
    )
    .unwrap()
}

#[test]
fn pictures_in_the_file_and_beside_it_are_read_once() {
    let within = scene(&square(json!({"index": 0})));
    assert_eq!(&*within.images[0].bytes, b"bytes of a picture");
    let texture = within.materials[0].texture.unwrap();
    assert_eq!(
        (texture.image, texture.wrap),
        (0, [Wrap::Clamp, Wrap::Mirror])
    );
    assert_eq!(within.meshes[0].uvs[1], [1.0, 1.0]);
    let mut made = square(json!({"index": 1}));
    let twice = made.json["materials"][0].clone();
    made.push("materials", twice);
    let beside = read_beside(&made);
    assert_eq!(
        (beside.images.len(), &*beside.images[0].bytes),
        (1, &b"nearby"[..])
    );
    assert_eq!(beside.materials[1].texture.unwrap().wrap, [Wrap::Repeat; 2]);
    assert!(beside.repairs.is_empty() && beside.remarks.is_empty());
}

#[test]
fn a_transform_moves_after_it_turned_after_it_scaled_and_may_name_another_set() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let transform = json!({
        "offset": [0.5, 0.25], "rotation": quarter, "scale": [2.0, 3.0], "texCoord": 1
    });
    let texture = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let scene = scene(&square(texture));
    assert_eq!(scene.meshes[0].uvs[3], [5.0, 5.0]);
    let lies = scene.materials[0].texture.unwrap().picture_from_uv;
    let found = lies.transform_point2(DVec2::new(1.0, 0.5));
    // (2, 1.5) turned by a quarter is (1.5, -2).
    assert!(found.distance(DVec2::new(2.0, -1.75)) < 1e-12, "{found}");
}

#[test]
fn a_mask_is_cut_where_factor_times_alpha_is_below_the_cutoff() {
    let mut made = square(json!({"index": 0}));
    let material = &mut made.json["materials"][0];
    material["alphaMode"] = json!("MASK");
    material["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, 0.8]);
    let cutoff = |made: &Made| scene(made).materials[0].texture.unwrap().cutoff;
    assert_eq!(cutoff(&made), Some(0.625));
    made.json["materials"][0]["alphaCutoff"] = json!(0.2);
    assert_eq!(cutoff(&made), Some(0.25));
    made.json["materials"][0]["alphaMode"] = json!("OPAQUE");
    assert_eq!(cutoff(&made), None);
}

#[test]
fn a_missing_picture_leaves_the_colour_and_is_named_also_one_outside_the_folder() {
    for index in [1, 2, 3, 9] {
        let made = square(json!({"index": index}));
        let scene = scene(&made);
        assert!(scene.materials[0].texture.is_none() && scene.images.is_empty());
        assert_eq!(scene.repairs["missing_images"], 1, "{index}");
        assert_eq!(scene.remarks.len(), 1, "{:?}", scene.remarks);
    }
    let mut made = square(json!({"index": 1}));
    for uri in ["../a.png", "/etc/a.png", "data:image/png;base64,@"] {
        made.json["images"][1]["uri"] = json!(uri);
        let scene = read(&made.glb(), "a", &mut Nowhere).unwrap();
        assert_eq!(scene.repairs["missing_images"], 1);
        let said = &scene.remarks[0];
        assert!(said.contains("a.png") || said.contains("base64"), "{said}");
    }
}

#[test]
fn gloss_tells_of_colours_before_metal_and_a_webp_may_stand_alone() {
    let mut made = square(json!({"index": 1}));
    made.json["materials"][0]["extensions"] = json!({"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.25, 1, 1], "diffuseTexture": {"index": 4},
    }});
    made.push(
        "textures",
        json!({"extensions": {"EXT_texture_webp": {"source": 0}}}),
    );
    let scene = scene(&made);
    assert_eq!(scene.materials[0].colour, [0.5, 0.25, 1.0, 1.0]);
    assert_eq!(&*scene.images[0].bytes, b"bytes of a picture");
    assert_eq!(scene.remarks, ["gloss is not drawn: 1 material"]);
}
