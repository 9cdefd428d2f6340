//! How is a small glTF file made?

use serde_json::{Value, json};

pub(super) const U8: u32 = 5121;
pub(super) const U16: u32 = 5123;
pub(super) const F32: u32 = 5126;

/// The corners of a square.
pub(super) const SQUARE: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

/// A document and its binary part.
pub(super) struct Made {
    pub(super) json: Value,
    pub(super) binary: Vec<u8>,
}

impl Made {
    /// No meshes; one scene with one node that shows mesh 0.
    pub(super) fn empty() -> Self {
        let json = json!({
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "buffers": [{"byteLength": 0}],
            "bufferViews": [],
            "accessors": [],
            "meshes": [{"primitives": []}],
        });
        Self {
            json,
            binary: Vec::new(),
        }
    }

    /// A square of two triangles with indices.
    pub(super) fn square() -> Self {
        let mut made = Self::empty();
        let positions = made.positions(&SQUARE);
        let indices = made.accessor(U8, "SCALAR", 6, &[0, 1, 2, 0, 2, 3]);
        made.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
        made
    }

    /// Adds bytes; gives the number of their view.
    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.binary.len().is_multiple_of(4) {
            self.binary.push(0);
        }
        let view = json!({
            "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len()
        });
        self.binary.extend(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.binary.len());
        self.push("bufferViews", view)
    }

    /// Adds elements; gives the number of their accessor.
    pub(super) fn accessor(
        &mut self,
        component: u32,
        shape: &str,
        count: usize,
        bytes: &[u8],
    ) -> usize {
        let view = self.view(bytes);
        let accessor = json!({
            "bufferView": view, "componentType": component, "type": shape, "count": count
        });
        self.push("accessors", accessor)
    }

    pub(super) fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        self.accessor(
            F32,
            "VEC3",
            positions.len(),
            &f32_bytes(positions.as_flattened()),
        )
    }

    /// Adds a part to mesh 0.
    pub(super) fn primitive(&mut self, primitive: Value) {
        let parts = self.json["meshes"][0]["primitives"].as_array_mut();
        parts.unwrap().push(primitive);
    }

    pub(super) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// As a `.glb`.
    pub(super) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.binary)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        let length = bytes.len() as u32;
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        bytes
    }

    /// As a `.gltf` whose buffer has a URI.
    pub(super) fn gltf(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["uri"] = json!(uri);
        json.to_string().into_bytes()
    }
}

pub(super) fn f32_bytes(numbers: &[f32]) -> Vec<u8> {
    numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect()
}
