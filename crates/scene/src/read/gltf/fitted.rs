//! How does JSON become a document if its members are of other kinds than glTF allows?
//!
//! Only what is still no glTF after its text was mended comes here. Of doubled members the last
//! counts, as in JavaScript; what is missing in a list of fixed length is what it would be without
//! the list; an empty list is an empty object where one is asked for. What cannot be read after
//! that is left out by itself: a member, else a material, a node, an accessor.

use serde::Deserialize;
use serde_json::{Map, Value};

use super::json::Document;

/// Lists of fixed length, and the values of numbers that are missing.
const LISTS: [(&str, &[f64]); 8] = [
    ("baseColorFactor", &[1.0; 4]),
    ("diffuseFactor", &[1.0; 4]),
    ("emissiveFactor", &[0.0; 3]),
    ("translation", &[0.0; 3]),
    ("rotation", &[0.0, 0.0, 0.0, 1.0]),
    ("scale", &[1.0; 3]),
    ("offset", &[0.0; 2]),
    ("center", &[0.0; 3]),
];
/// Members that are objects.
const OBJECTS: [&str; 12] = [
    "asset",
    "attributes",
    "extensions",
    "extras",
    "indices",
    "values",
    "sparse",
    "pbrMetallicRoughness",
    "baseColorTexture",
    "diffuseTexture",
    "emissiveTexture",
    "KHR_texture_transform",
];
/// Members that are lists of numbers that name something.
const NAMING: [&str; 3] = ["children", "joints", "nodes"];
/// Lists of what numbers are made of: a part of what says where they are may be any.
const NUMBERS: [&str; 3] = ["accessors", "bufferViews", "buffers"];
/// Members that are lists of objects.
const LISTED: [&str; 2] = ["primitives", "targets"];
/// Members that are texts.
const TEXTS: [&str; 6] = ["name", "uri", "type", "alphaMode", "mimeType", "filter"];
/// Kinds of numbers by the names that OpenGL gives them.
const COMPONENTS: [(&str, u32); 9] = [
    ("BYTE", 5120),
    ("UNSIGNED_BYTE", 5121),
    ("SHORT", 5122),
    ("UNSIGNED_SHORT", 5123),
    ("INT", 5124),
    ("UNSIGNED_INT", 5125),
    ("FLOAT", 5126),
    ("DOUBLE", 5130),
    ("HALF_FLOAT", 5131),
];
/// Ways to make triangles from corners, numbered from 0.
const MODES: [&str; 7] = [
    "POINTS",
    "LINES",
    "LINE_LOOP",
    "LINE_STRIP",
    "TRIANGLES",
    "TRIANGLE_STRIP",
    "TRIANGLE_FAN",
];

/// The document in a text of JSON, and how many mends it needed, at least one. `None` if the text
/// is not JSON, or not an object whose lists are lists.
pub(super) fn fitted(text: &[u8]) -> Option<(Document, usize)> {
    // This keeps the last of members given twice.
    let Value::Object(mut all) = serde_json::from_slice(text).ok()? else {
        return None;
    };
    let mut mended = 0;
    let mut document = Document {
        asset: one(all.remove("asset"), "asset", &mut mended),
        scene: one(all.remove("scene"), "scene", &mut mended),
        extensions: one(all.remove("extensions"), "extensions", &mut mended),
        ..Document::default()
    };
    document.scenes = list(&mut all, "scenes", &mut mended)?;
    document.nodes = list(&mut all, "nodes", &mut mended)?;
    document.meshes = list(&mut all, "meshes", &mut mended)?;
    document.skins = list(&mut all, "skins", &mut mended)?;
    document.materials = list(&mut all, "materials", &mut mended)?;
    document.accessors = list(&mut all, "accessors", &mut mended)?;
    document.buffer_views = list(&mut all, "bufferViews", &mut mended)?;
    document.buffers = list(&mut all, "buffers", &mut mended)?;
    document.textures = list(&mut all, "textures", &mut mended)?;
    document.images = list(&mut all, "images", &mut mended)?;
    document.samplers = list(&mut all, "samplers", &mut mended)?;
    document.animations = list(&mut all, "animations", &mut mended)?;
    document.extensions_used = list(&mut all, "extensionsUsed", &mut mended)?;
    document.extensions_required = list(&mut all, "extensionsRequired", &mut mended)?;
    Some((document, mended.max(1)))
}

/// A list of the document; `None` where it is anything else.
fn list<'a, T: Deserialize<'a> + Default>(
    all: &mut Map<String, Value>,
    name: &str,
    mended: &mut usize,
) -> Option<Vec<T>> {
    match all.remove(name) {
        Some(Value::Array(list)) => {
            let each = list.into_iter();
            Some(each.map(|it| one(Some(it), name, mended)).collect())
        }
        Some(Value::Object(members)) if members.is_empty() => Some(Vec::new()),
        None | Some(Value::Null) => Some(Vec::new()),
        Some(_) => None,
    }
}

/// A value, mended where necessary; the default where it cannot be read.
fn one<'a, T: Deserialize<'a> + Default>(
    value: Option<Value>,
    name: &str,
    mended: &mut usize,
) -> T {
    let Some(mut value) = value else {
        return T::default();
    };
    if let Ok(read) = T::deserialize(value.clone()) {
        return read;
    }
    *mended += 1;
    mend(name, &mut value);
    // What is wrong with one member leaves the others, but of lists of numbers.
    if let (Value::Object(members), false) = (&mut value, NUMBERS.contains(&name)) {
        members.retain(|name, it| {
            let alone = Map::from_iter([(name.clone(), it.clone())]);
            T::deserialize(Value::Object(alone)).is_ok()
        });
    }
    T::deserialize(value).unwrap_or_default()
}

/// Mends the value of a member, and everything within it.
fn mend(name: &str, value: &mut Value) {
    if LISTED.contains(&name) && value.is_object() {
        *value = Value::Array(vec![value.take()]);
    }
    if let Value::Object(members) = value {
        members.retain(|_, it| !it.is_null());
        let is_scaled = name == "KHR_texture_transform";
        for (name, it) in members.iter_mut() {
            match LISTS.iter().find(|list| list.0 == name) {
                // A texture has two scales, and one number for its rotation.
                Some(_) if is_scaled && name == "rotation" => {}
                Some((_, usual)) if is_scaled => fill(name, it, &usual[..2.min(usual.len())]),
                Some((_, usual)) => fill(name, it, usual),
                None => mend(name, it),
            }
        }
        // A list of another length is not a matrix.
        let is_matrix = |it: &Value| it.as_array().is_some_and(|it| it.len() == 16);
        members.retain(|name, it| name != "matrix" || is_matrix(it));
        members.retain(|_, it| !it.is_null());
        return;
    }
    let small = value.as_str().map(str::to_ascii_uppercase);
    match value {
        Value::Array(list) if NAMING.contains(&name) => {
            list.retain(|it| it.as_u64().is_some());
        }
        Value::Array(list) if OBJECTS.contains(&name) && list.is_empty() => {
            *value = Value::Object(Map::new());
        }
        Value::Array(list) => {
            for it in list {
                match it {
                    // The other objects of the list keep their numbers.
                    Value::Null => *it = Value::Object(Map::new()),
                    it => mend("", it),
                }
            }
        }
        Value::Number(_) if NAMING.contains(&name) => {
            *value = Value::Array(vec![value.take()]);
        }
        Value::Number(number) if TEXTS.contains(&name) => {
            *value = Value::String(number.to_string());
        }
        Value::String(_) => {
            let named = small.as_deref().unwrap_or("");
            let mode = MODES.iter().position(|it| *it == named);
            let component = COMPONENTS.iter().find(|it| it.0 == named);
            match (name, mode, component) {
                ("mode", Some(mode), _) => *value = mode.into(),
                ("componentType", _, Some((_, code))) => *value = (*code).into(),
                _ => {}
            }
        }
        _ => {}
    }
}

/// Makes a list of numbers as long as it should be; a single number fills a scale or a colour.
fn fill(name: &str, value: &mut Value, usual: &[f64]) {
    let said: Vec<Option<f64>> = match value {
        Value::Array(list) => list.iter().map(Value::as_f64).collect(),
        Value::Number(number) if name != "rotation" => vec![number.as_f64(); usual.len().min(3)],
        _ => Vec::new(),
    };
    let number = |at: usize| said.get(at).copied().flatten();
    let mut full: Vec<f64> = (0..usual.len())
        .map(|at| number(at).unwrap_or(usual[at]))
        .collect();
    // The fourth part of a rotation follows from the others.
    if let ("rotation", [x, y, z, w], None) = (name, &mut full[..], number(3)) {
        *w = (1.0 - *x * *x - *y * *y - *z * *z).max(0.0).sqrt();
    }
    *value = full.into();
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn lists_that_are_too_short_are_filled_and_what_is_none_is_left_out() {
        for (said, told) in [
            (
                json!({"scale": [2, 3], "rotation": [0, 0, 0]}),
                json!({"scale": [2.0, 3.0, 1.0], "rotation": [0.0, 0.0, 0.0, 1.0]}),
            ),
            (
                json!({"translation": [1, null, 2, 5], "matrix": [1, 2]}),
                json!({"translation": [1.0, 0.0, 2.0]}),
            ),
            (
                json!({"children": [1, null, -1], "extensions": [], "name": 7}),
                json!({"children": [1], "extensions": {}, "name": "7"}),
            ),
            (
                json!({"KHR_texture_transform": {"scale": [2], "rotation": 1.5}}),
                json!({"KHR_texture_transform": {"scale": [2.0, 1.0], "rotation": 1.5}}),
            ),
            (
                json!({"primitives": {"mode": "triangles"}}),
                json!({"primitives": [{"mode": 4}]}),
            ),
            (
                json!({"mode": "triangles", "componentType": "FLOAT"}),
                json!({"mode": 4, "componentType": 5126}),
            ),
        ] {
            let mut value = said.clone();
            mend("", &mut value);
            assert_eq!(value, told, "{said}");
        }
    }

    #[test]
    fn one_of_a_list_that_cannot_be_read_leaves_the_others() {
        let text = br#"{"materials": [{"doubleSided": "yes", "alphaCutoff": 0.25}],
            "scene": 0, "scene": 1, "nodes": [{"mesh": []}, {"mesh": 3}, null]}"#;
        let (document, mended) = fitted(text).unwrap();
        assert_eq!(document.scene, Some(1));
        let meshes: Vec<_> = document.nodes.iter().map(|it| it.mesh).collect();
        assert_eq!((meshes, mended), (vec![None, Some(3), None], 3));
        assert_eq!(document.materials[0].alpha_cutoff, Some(0.25));
        for none in [&b"[]"[..], b"{", br#"{"nodes": {"0": {}}}"#] {
            assert!(fitted(none).is_none());
        }
    }
}
