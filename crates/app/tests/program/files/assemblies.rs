//! Are models of very many parts, and of parts in very many places, prepared and shown?

use crate::support::{Folder, Rgb, command, done, finish, glb, json};
use serde_json::{Value, json as made};

/// A `.glb` of so many boxes, each a mesh of its own with a name, in so many places each.
fn boxes(parts: usize, places: usize) -> Vec<u8> {
    let side = (1..)
        .find(|side| side * side * side >= parts * places)
        .unwrap();
    let (mut bytes, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    let corners: [u16; 36] = [
        0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2,
        1, 3, 7, 1, 7, 5,
    ];
    bytes.extend(corners.iter().flat_map(|it| it.to_le_bytes()));
    views.push(made!({"buffer": 0, "byteLength": 72}));
    accessors.push(made!({
        "bufferView": 0, "componentType": 5123, "count": 36, "type": "SCALAR",
    }));
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for part in 0..parts {
        let sides = [0.4, 0.5, 0.3 + 0.02 * (part % 17) as f32];
        views.push(made!({"buffer": 0, "byteOffset": bytes.len(), "byteLength": 96}));
        for corner in 0..8 {
            let at = [0, 1, 2].map(|axis| sides[axis] * (corner >> axis & 1) as f32);
            bytes.extend(at.iter().flat_map(|it| it.to_le_bytes()));
        }
        accessors.push(made!({
            "bufferView": part + 1, "componentType": 5126, "count": 8, "type": "VEC3",
            "min": [0, 0, 0], "max": sides,
        }));
        meshes.push(made!({
            "name": format!("Basic wall: generic {part}"),
            "primitives": [{"attributes": {"POSITION": part + 1}, "indices": 0,
                "material": part % 2}],
        }));
        for place in 0..places {
            let at = part * places + place;
            let at = [at % side, at / side % side, at / side / side];
            nodes.push(made!({"mesh": part, "translation": at}));
        }
    }
    let count = nodes.len();
    let json = made!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": (0..count).collect::<Vec<_>>()}],
        "nodes": nodes, "meshes": meshes, "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": bytes.len()}],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.3, 0.1, 1]}},
            {"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.4, 0.8, 1]}},
        ],
    });
    glb(&json, &bytes)
}

/// What preparing reports, after `info` said the same and `verify` found nothing.
fn prepared(folder: &Folder, name: &str, file: &[u8]) -> (String, Value) {
    let file = folder.holding(name, file);
    let pack = folder.name(&format!("{name}.foveal"));
    let told = json(&["prepare", "scene", &file, "--out", &pack]);
    let known = json(&["info", &pack]);
    for key in [
        "objects",
        "placements",
        "bundles",
        "leaf_triangles",
        "repairs",
    ] {
        assert_eq!(told[key], known[key], "{name}: {key}");
    }
    assert_eq!(json(&["verify", &pack])["ok"], true, "{name}");
    (pack, told)
}

/// Bytes until the first picture, of those of the pack; the last picture lies in `out`.
fn shown(folder: &Folder, pack: &str, policy: &str) -> f64 {
    let out = folder.name(policy);
    let run = json(&[
        "simulate",
        pack,
        "--out",
        &out,
        "--view",
        "192x128",
        "--renderer",
        "cpu",
        "--policy",
        policy,
        "--frames",
        "1",
        "--pictures",
        "png",
    ]);
    let bytes = run["first_picture_bytes"].as_f64().unwrap();
    bytes / std::fs::metadata(pack).unwrap().len() as f64
}

/// How many pixels of a picture differ from its corner.
fn drawn(folder: &Folder, policy: &str) -> usize {
    let picture = folder.name(&format!("{policy}/frame_00000.png"));
    let picture = Rgb::read(&picture);
    let ground = picture.at([0, 0]);
    picture
        .places()
        .filter(|at| picture.at(*at) != ground)
        .count()
}

#[test]
fn a_building_of_very_many_named_parts_is_shown_after_a_fiftieth_of_its_pack() {
    let folder = Folder::new();
    let (pack, told) = prepared(&folder, "building.glb", &boxes(5000, 1));
    assert_eq!(
        (&told["objects"], &told["placements"]),
        (&5000.into(), &5000.into())
    );
    assert_eq!(told["leaf_triangles"], 60_000);
    assert!(told["bundles"].as_u64().unwrap() > 0, "{told}");
    let bytes = std::fs::read(&pack).unwrap();
    let name = b"Basic wall: generic 4321";
    assert!(
        bytes.windows(name.len()).any(|it| it == name),
        "names are kept"
    );
    let share = shown(&folder, &pack, "coarsest");
    assert!(share <= 0.02, "{share}");
    shown(&folder, &pack, "full");
    assert!(drawn(&folder, "full") > 192 * 128 / 10);
    // A byte of the table of names is checked as all others are.
    let mut damaged = bytes.clone();
    let at = bytes.windows(name.len()).position(|it| it == name).unwrap();
    damaged[at] ^= 1;
    let damaged = folder.holding("damaged.foveal", &damaged);
    assert_eq!(finish(command(&["verify", &damaged])).code, Some(1));
}

#[test]
fn one_mesh_in_a_hundred_thousand_places_is_sent_once() {
    let folder = Folder::new();
    let points = (0..100_000).map(|k| [k % 50, k / 50 % 50, k / 2500]);
    let mut bytes: Vec<u8> = points
        .flat_map(|it| it.map(|it| it as f32 * 2.0))
        .flat_map(f32::to_le_bytes)
        .collect();
    let at = bytes.len();
    let corners = [
        [0.0_f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    bytes.extend(
        corners
            .as_flattened()
            .iter()
            .flat_map(|it| it.to_le_bytes()),
    );
    let triangles: [u16; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    bytes.extend(triangles.iter().flat_map(|it| it.to_le_bytes()));
    let json = made!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
        "extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "nodes": [{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {
            "attributes": {"TRANSLATION": 0}}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 2}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 100_000, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 2, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": at},
            {"buffer": 0, "byteOffset": at, "byteLength": 48},
            {"buffer": 0, "byteOffset": at + 48, "byteLength": 24},
        ],
        "buffers": [{"byteLength": bytes.len()}],
    });
    let (pack, told) = prepared(&folder, "forest.glb", &glb(&json, &bytes));
    assert_eq!(
        (&told["objects"], &told["placements"]),
        (&1.into(), &100_000.into())
    );
    let bytes = told["bytes"].as_u64().unwrap();
    assert!(bytes < 20 * 100_000, "{bytes}");
    shown(&folder, &pack, "full");
    assert!(drawn(&folder, "full") > 192 * 128 / 10);
}

#[test]
fn meshes_in_many_places_each_are_all_there() {
    let folder = Folder::new();
    let (_, told) = prepared(&folder, "plant.glb", &boxes(600, 5));
    assert_eq!(
        (&told["objects"], &told["placements"]),
        (&600.into(), &3000.into())
    );
    let said = done(&["info", &folder.name("plant.glb.foveal")]).stdout;
    assert!(said.contains("600 objects"), "{said}");
}
