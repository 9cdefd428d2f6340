//! Does the reader accept what other readers accept, and report it?

use serde_json::{Value, json};

use super::super::super::files::Nowhere;
use super::super::read;
use super::made::{F32, Made, SQUARE, U16, f32_bytes};
use super::scene;
use crate::source::SourceScene;

/// A good square after one change.
fn changed(change: impl Fn(&mut Made)) -> SourceScene {
    let mut made = Made::square();
    change(&mut made);
    scene(&made)
}

/// Asserts that a scene shows the square, and reports one mend.
#[track_caller]
fn assert_square(scene: &SourceScene, name: &str) {
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{name}");
    let places: Vec<[f32; 3]> = mesh
        .positions
        .iter()
        .map(|it| it.as_vec3().into())
        .collect();
    assert_eq!(places, SQUARE, "{name}");
    assert!(scene.repairs[name] > 0, "{name}: {:?}", scene.repairs);
    assert_eq!(scene.remarks.len(), 1, "{:?}", scene.remarks);
}

/// Replaces the positions of the square.
fn with_positions(made: &mut Made, component: u32, bytes: &[u8]) {
    let positions = made.accessor(component, "VEC3", 4, bytes);
    made.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
}

#[test]
fn numbers_of_kinds_that_only_opengl_has_are_read() {
    let flat = SQUARE.as_flattened();
    let doubles: Vec<u8> = flat
        .iter()
        .flat_map(|it| f64::from(*it).to_le_bytes())
        .collect();
    let halves: Vec<u8> = flat
        .iter()
        .flat_map(|it| if *it > 0.0 { [0, 0x3c] } else { [0, 0] })
        .collect();
    let name = "components_of_another_kind";
    assert_square(&changed(|it| with_positions(it, 5130, &doubles)), name);
    assert_square(&changed(|it| with_positions(it, 5131, &halves)), name);
    let indices: Vec<u8> = [0_i32, 1, 2, 0, 2, 3]
        .iter()
        .flat_map(|it| it.to_le_bytes())
        .collect();
    let with_indices = |made: &mut Made| {
        let number = made.accessor(5124, "SCALAR", 6, &indices);
        made.json["meshes"][0]["primitives"][0]["indices"] = json!(number);
    };
    assert_square(&changed(with_indices), name);
}

#[test]
fn lengths_that_cannot_be_are_taken_as_meant() {
    let stride = |it: &mut Made| it.json["bufferViews"][0]["byteStride"] = json!(4);
    assert_square(&changed(stride), "strides_mended");
    let view = |it: &mut Made| it.json["bufferViews"][0]["byteLength"] = json!(0);
    assert_square(&changed(view), "views_without_length");
    for length in [json!(0), json!(7)] {
        let told = changed(|it| it.json["buffers"][0]["byteLength"] = length.clone());
        assert_eq!(told.meshes[0].triangles.len(), 2);
    }
}

#[test]
fn names_that_are_nearly_right_are_taken() {
    let rename = |made: &mut Made| {
        let attributes = &mut made.json["meshes"][0]["primitives"][0]["attributes"];
        *attributes = json!({"position": attributes["POSITION"]});
        made.json["accessors"][0]["type"] = json!("vec3");
    };
    let told = changed(rename);
    assert_square(&told, "json_mended");
    assert_eq!(told.repairs["json_mended"], 2);
    // A member with the right name stays.
    let both = |made: &mut Made| {
        made.json["meshes"][0]["primitives"][0]["attributes"]["position"] = json!(1);
    };
    assert!(changed(both).repairs.is_empty());
}

#[test]
fn json_of_other_kinds_than_gltf_has_is_taken() {
    type Change = fn(&mut Value);
    let changes: [Change; 8] = [
        |it| it["scenes"][0]["nodes"] = json!([0, null]),
        |it| it["nodes"][0] = json!({"mesh": 0, "children": null, "scale": null}),
        |it| it["meshes"][0]["primitives"][0]["mode"] = json!("4"),
        |it| it["meshes"][0]["primitives"][0]["mode"] = json!("triangles"),
        |it| it["nodes"][0]["scale"] = json!([1, 1]),
        |it| it["nodes"][0]["rotation"] = json!([0, 0, 0]),
        |it| it["nodes"][0]["translation"] = json!([0]),
        |it| it["accessors"][0]["componentType"] = json!("FLOAT"),
    ];
    for (number, change) in changes.iter().enumerate() {
        let told = changed(|it| change(&mut it.json));
        assert_square(&told, "json_mended");
        let place = told.objects[0].placements[0];
        assert_eq!(place, glam::DAffine3::IDENTITY, "change {number}");
    }
    // If a member is given twice, the last one counts.
    let made = Made::square();
    let text = made.gltf("a.bin");
    let text = String::from_utf8(text).unwrap();
    let twice = text.replacen("\"mesh\":0", "\"mesh\":9,\"mesh\":0", 1);
    let mut folder = super::super::super::files::Files([("a.bin", made.binary.clone())].into());
    assert_square(
        &read(twice.as_bytes(), "a", &mut folder).unwrap(),
        "json_mended",
    );
}

#[test]
fn a_material_that_cannot_be_read_costs_itself_alone() {
    let told = changed(|it| {
        it.json["materials"] = json!([{"pbrMetallicRoughness": 7, "alphaCutoff": []}]);
        it.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    assert_square(&told, "json_mended");
    assert_eq!(told.materials[0].colour, [1.0; 4]);
}

fn with_material(material: &Value) -> SourceScene {
    changed(|it| {
        it.json["materials"] = json!([material]);
        it.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    })
}

#[test]
fn factors_up_to_255_are_codes_and_short_ones_are_opaque() {
    for (factor, name) in [
        (json!([255, 0, 51, 1]), "colours_rescaled"),
        (json!([255, 0, 51, 255]), "colours_rescaled"),
        (json!([1, 0, 0.2]), "json_mended"),
    ] {
        let said = json!({"pbrMetallicRoughness": {"baseColorFactor": factor}});
        let told = with_material(&said);
        assert_square(&told, name);
        assert_eq!(told.materials[0].colour, [1.0, 0.0, 0.2, 1.0], "{factor}");
    }
}

#[test]
fn normalised_colours_of_sixteen_bits_that_hold_eight_are_rescaled() {
    let with_codes = |most: u16| {
        changed(|it| {
            let codes = [most, 0, most / 2, most].repeat(4);
            let bytes: Vec<u8> = codes.iter().flat_map(|it| it.to_le_bytes()).collect();
            let colours = it.accessor(U16, "VEC4", 4, &bytes);
            it.json["accessors"][colours]["normalized"] = json!(true);
            let part = &mut it.json["meshes"][0]["primitives"][0];
            part["attributes"]["COLOR_0"] = json!(colours);
        })
    };
    for most in [255, 4095] {
        let told = with_codes(most);
        assert_square(&told, "colours_rescaled");
        let [red, green, blue, _] = told.meshes[0].colours[0];
        assert!(red == 1.0 && green == 0.0 && (blue - 0.5).abs() < 0.01);
    }
    let whole = with_codes(65_535);
    assert!(whole.repairs.is_empty() && whole.meshes[0].colours[0][0] == 1.0);
}

#[test]
fn a_texture_without_coordinates_is_told() {
    let texture = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let told = with_material(&texture);
    assert_eq!(told.repairs["textures_without_coordinates"], 1);
    assert!(told.remarks.iter().any(|it| it.contains("TEXCOORD_0")));
}

#[test]
fn what_is_half_transparent_is_told_once_with_how_many() {
    let materials = json!([
        {"name": "glass", "alphaMode": "BLEND"},
        {"alphaMode": "mask", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}},
        {"alphaMode": "MASK"},
        {"alphaMode": "OPAQUE", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}}
    ]);
    let told = changed(|it| it.json["materials"] = materials.clone());
    assert_eq!(told.repairs["drawn_opaque"], 1);
    // What is cut out as a whole is hidden.
    let opacities: Vec<f32> = told.materials.iter().map(|it| it.colour[3]).collect();
    assert_eq!(opacities[..4], [1.0, 0.0, 1.0, 1.0]);
    let has = |it: &String| it.contains("1 material") && it.contains("glass");
    assert!(told.remarks.iter().any(has), "{:?}", told.remarks);
}

#[test]
fn places_that_count_from_a_centre_stand_there() {
    let told = changed(|it| {
        it.json["extensionsRequired"] = json!(["CESIUM_RTC", "FB_ngon_encoding"]);
        it.json["extensions"] = json!({"CESIUM_RTC": {"center": [1e6, 2e6, 3e6]}});
        it.json["nodes"] = json!([{"children": [1]}, {"mesh": 0}]);
    });
    let at = told.objects[0].placements[0].translation;
    assert_eq!(at.to_array(), [1e6, 2e6, 3e6]);
    assert!(told.remarks.iter().any(|it| it.contains("CESIUM_RTC")));
    let bytes = f32_bytes(SQUARE.as_flattened());
    assert_eq!(
        changed(|it| with_positions(it, F32, &bytes)).remarks.len(),
        0
    );
    assert!(read(b"{", "a", &mut Nowhere).is_err());
}
