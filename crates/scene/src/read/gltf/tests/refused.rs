//! Is what breaks the format mended where that can be, else refused with its place and what to do
//! next?

use serde_json::{Value, json};

use super::super::super::files::Nowhere;
use super::super::read;
use super::made::{F32, Made};
use super::{refusal, scene};

/// What is said of a good file after one change.
fn refused(change: impl Fn(&mut Value)) -> String {
    let mut made = Made::square();
    change(&mut made.json);
    refusal(&made.glb())
}

#[track_caller]
fn assert_says(refused: &str, what: &str) {
    assert!(
        refused.starts_with("a.glb: ") && refused.contains(what),
        "{refused}"
    );
    assert!(refused.contains("; "), "it says what to do next: {refused}");
}

/// What is counted of a good file after one change, whose triangles stay.
#[track_caller]
fn assert_mends(triangles: usize, name: &str, change: impl Fn(&mut Value)) {
    let mut made = Made::square();
    change(&mut made.json);
    let scene = scene(&made);
    assert_eq!(scene.meshes[0].triangles.len(), triangles, "{name}");
    assert_eq!(scene.repairs[name], 1, "{name}");
    assert!(!scene.remarks.is_empty(), "{name}");
}

#[test]
fn of_counts_and_views_beyond_the_buffer_what_exists_is_read() {
    for count in [5, u64::MAX] {
        assert_mends(2, "accessors_cut", |json| {
            json["accessors"][0]["count"] = json!(count);
        });
    }
    assert_mends(2, "views_cut", |json| {
        json["bufferViews"][0]["byteLength"] = json!(u64::MAX);
    });
    assert_mends(2, "views_cut", |json| {
        json["buffers"][0]["byteLength"] = json!(1000);
        json["bufferViews"][1]["byteLength"] = json!(900);
    });
    let said = refused(|json| json["accessors"][0]["byteOffset"] = json!(u64::MAX));
    assert_says(&said, "accessor 0: 4 elements");
}

#[test]
fn elements_without_bytes_are_not_believed() {
    let said = refused(|json| {
        json["accessors"][0] =
            json!({"componentType": F32, "type": "VEC3", "count": 4_000_000_000u32});
    });
    assert_says(&said, "accessor 0: its 4000000000 elements without bytes");
}

#[test]
fn a_small_file_cannot_show_its_bytes_without_end() {
    let said = refused(|json| {
        let part = json["meshes"][0]["primitives"][0].clone();
        json["meshes"][0]["primitives"] = json!(vec![part; 100_000]);
    });
    assert_says(&said, "are made of only 54 bytes");
}

#[test]
fn numbers_of_what_is_not_there_cost_what_needs_it() {
    type Change = fn(&mut Value);
    let mended: [(Change, &str); 3] = [
        (|j| j["scene"] = json!(1), "scenes_not_found"),
        (|j| j["nodes"][0]["skin"] = json!(7), "places_mended"),
        (
            |j| j["meshes"][0]["primitives"][0]["material"] = json!(7),
            "materials_not_found",
        ),
    ];
    for (change, name) in mended {
        assert_mends(2, name, change);
    }
    assert_mends(2, "nodes_not_found", |j| {
        j["scenes"][0]["nodes"] = json!([0, 7]);
    });
    let changes: [(Change, &str); 4] = [
        (
            |j| j["meshes"][0]["primitives"][0]["indices"] = json!(7),
            "accessor 7: ",
        ),
        (
            |j| j["accessors"][0]["bufferView"] = json!(7),
            "buffer view 7: ",
        ),
        (
            |j| j["bufferViews"][0]["buffer"] = json!(7),
            "names buffer 7",
        ),
        (
            |j| j["meshes"][0]["primitives"][0]["mode"] = json!(7),
            "its mode is 7",
        ),
    ];
    for (change, what) in changes {
        assert_says(&refused(change), what);
        // Another part is there all the same.
        let mut made = Made::square();
        let part = made.json["meshes"][0]["primitives"][0].clone();
        if !what.starts_with("names") && !what.starts_with("buffer") {
            change(&mut made.json);
            let parts = made.json["meshes"][0]["primitives"].as_array_mut().unwrap();
            if what.starts_with("accessor") || what.starts_with("its mode") {
                parts.push(part);
            }
            let scene = scene(&made);
            assert_eq!(scene.meshes[0].triangles.len(), 2, "{what}");
            assert_eq!(scene.repairs["parts_left_out"], 1, "{what}");
        }
    }
    let mut made = Made::square();
    made.json["nodes"][0]["mesh"] = json!(7);
    let nothing = scene(&made);
    assert!(nothing.objects.is_empty());
    assert!(nothing.remarks[0].contains("mesh 7, named by node 0"));
}

#[test]
fn corners_of_odd_kinds_are_refused() {
    let said = refused(|json| json["accessors"][0]["componentType"] = json!(5140));
    assert_says(&said, "its component type is 5140");
    let said = refused(|json| json["accessors"][0]["type"] = json!("VEC2"));
    assert_says(&said, "its type is VEC2");
    let said = refused(|json| json["accessors"][1]["normalized"] = json!(true));
    assert_says(&said, "unsigned whole numbers");
}

#[test]
fn nodes_in_circles_are_shown_once_and_those_with_two_parents_below_both() {
    assert_mends(2, "nodes_in_themselves", |json| {
        json["nodes"] = json!([{"children": [1]}, {"children": [0], "mesh": 0}]);
    });
    assert_mends(2, "nodes_in_themselves", |json| {
        json["nodes"] = json!([{"children": [0], "mesh": 0}]);
        json["scenes"] = json!([]);
    });
    let mut made = Made::square();
    made.json["nodes"] = json!([
        {"children": [1, 2]},
        {"children": [2], "translation": [0, 2, 0]},
        {"mesh": 0},
    ]);
    let scene = scene(&made);
    assert_eq!(scene.objects[0].placements.len(), 2);
    assert_eq!(scene.repairs["nodes_with_several_parents"], 1);
}

#[test]
fn transforms_that_are_none_are_left_out() {
    assert_mends(2, "places_mended", |json| {
        json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]);
    });
    assert_mends(2, "places_mended", |json| {
        json["nodes"][0]["matrix"] = json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    });
}

#[test]
fn extensions_that_are_needed_are_refused_by_name() {
    let said = refused(|json| json["extensionsRequired"] = json!(["VENDOR_odd"]));
    assert_says(&said, "VENDOR_odd");
    assert_says(&said, "export it without");
}

#[test]
fn other_versions_and_wrong_json_are_refused() {
    let said = refused(|json| json["asset"]["version"] = json!("1.0"));
    assert_says(&said, "it is glTF 1.0, which is not supported; convert it");
    let said = refused(|json| json["asset"]["version"] = json!("3.0"));
    assert_says(
        &said,
        "\"3.0\", which is not supported; export it as glTF 2.0",
    );
    let said = refused(|json| json["nodes"] = json!({"0": {}}));
    assert_says(&said, "JSON, line 1 column");
    let said = refused(|json| json["accessors"][0]["count"] = json!(-1));
    assert_says(&said, "accessor 0: ");
    assert_says(&refusal(b"{"), "JSON, line 1 column");
    let said = refused(|json| json["nodes"] = json!(vec![json!({}); 200_000]));
    assert_says(&said, "JSON: 200");
    let deep = "[".repeat(100_000);
    assert_says(&refusal(format!("{{\"nodes\":{deep}").as_bytes()), "JSON");
}

#[test]
fn missing_buffers_and_those_outside_the_folder_are_refused() {
    let made = Made::square();
    assert_says(
        &refusal(&made.gltf("b.bin")),
        "its file \"b.bin\" cannot be read",
    );
    for uri in [
        "../b.bin",
        "%2e%2e/b.bin",
        "/etc/passwd",
        "file:///etc/passwd",
    ] {
        assert_says(&refusal(&made.gltf(uri)), "does not lie in the folder");
    }
    assert_says(&refusal(&made.gltf("data:;base64,x")), "is no base64");
    let bare = made.json.to_string();
    assert_says(&refusal(bare.as_bytes()), "buffer 0: has no uri");
}

#[test]
fn of_cut_binary_files_what_exists_is_read() {
    let whole = Made::square().glb();
    assert_says(&refusal(&whole[..10]), "byte 10: ");
    let cut = read(&whole[..whole.len() - 1], "a", &mut Nowhere).unwrap();
    assert_eq!(cut.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(cut.repairs["lengths_mended"], 1);
    for length in [0_u32, 100, u32::MAX] {
        let mut other = whole.clone();
        other[8..12].copy_from_slice(&length.to_le_bytes());
        let scene = read(&other, "a", &mut Nowhere).unwrap();
        assert_eq!(scene.meshes[0].triangles.len(), 2, "{length}");
        assert_eq!(scene.repairs["lengths_mended"], 1, "{length}");
    }
    let mut long = whole;
    long[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_says(&refusal(&long), "byte 12: a chunk of 4294967295 bytes");
}
