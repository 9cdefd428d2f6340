//! Do compressed parts say what they said before?

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute,
};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{
    ExpMode, IndexEncoding, VertexEncoding, encode_filter_exp, encode_filter_oct,
    encode_index_buffer, encode_index_sequence, encode_vertex_buffer,
};
use serde_json::{Value, json};

use super::super::super::SceneFormat;
use super::super::super::mangle::cut_and_flip;
use super::made::{F32, Made, SQUARE, f32_bytes};
use super::{refusal, scene};

const I8: u32 = 5120;
const U32: u32 = 5125;
const EXT: &str = "EXT_meshopt_compression";
const KHR: &str = "KHR_meshopt_compression";
const INDICES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// A view whose bytes are compressed and whose fallback has none.
struct Packed<'a> {
    name: &'a str,
    bytes: Vec<u8>,
    stride: usize,
    mode: &'a str,
    filter: &'a str,
}

impl Made {
    fn packed(&mut self, (component, shape): (u32, &str), count: usize, it: &Packed<'_>) -> usize {
        let accessor = self.accessor(component, shape, count, &it.bytes);
        let view = &mut self.json["bufferViews"][accessor];
        let (offset, length) = (view["byteOffset"].clone(), view["byteLength"].clone());
        *view = json!({
            "buffer": 1, "byteLength": count * it.stride, "byteStride": it.stride,
            "extensions": {it.name: {
                "buffer": 0, "byteOffset": offset, "byteLength": length,
                "byteStride": it.stride, "count": count, "mode": it.mode, "filter": it.filter,
            }},
        });
        if shape == "SCALAR" {
            view.as_object_mut().unwrap().remove("byteStride");
        }
        self.json["buffers"][1] = json!({"byteLength": 9000, "uri": "gone.bin", "extensions": {it.name: {"fallback": true}}});
        accessor
    }
}

fn attributes(bytes: &[u8], count: usize, encoding: VertexEncoding) -> Vec<u8> {
    let mut work = Workspace::default();
    encode_vertex_buffer(bytes, count, bytes.len() / count, encoding, &mut work).unwrap()
}

/// A square whose positions, normals and indices meshoptimizer compressed.
fn square(name: &str, mode: &str) -> Made {
    let mut work = Workspace::default();
    let encoding = match name {
        EXT => VertexEncoding::new(0, 2).unwrap(),
        _ => VertexEncoding::DEFAULT,
    };
    let mut made = Made::empty();
    made.json["buffers"].as_array_mut().unwrap().push(json!({}));
    made.json["extensionsRequired"] = json!([name, "KHR_mesh_quantization"]);
    let exponents = encode_filter_exp(
        4,
        12,
        20,
        SQUARE.as_flattened(),
        ExpMode::Separate,
        &mut work,
    );
    let positions = made.packed(
        (F32, "VEC3"),
        4,
        &Packed {
            name,
            bytes: attributes(&exponents.unwrap(), 4, encoding),
            stride: 12,
            mode: "ATTRIBUTES",
            filter: "EXPONENTIAL",
        },
    );
    let normals = [0.6, 0.0, 0.8, 0.0].repeat(4);
    let octahedral = encode_filter_oct(4, 4, 8, &normals, &mut work).unwrap();
    let normals = made.packed(
        (I8, "VEC3"),
        4,
        &Packed {
            name,
            bytes: attributes(&octahedral, 4, encoding),
            stride: 4,
            mode: "ATTRIBUTES",
            filter: "OCTAHEDRAL",
        },
    );
    made.json["accessors"][normals]["normalized"] = json!(true);
    let indices = match mode {
        "TRIANGLES" => encode_index_buffer(&INDICES, IndexEncoding::DEFAULT, &mut work),
        _ => encode_index_sequence(&INDICES, IndexEncoding::DEFAULT, &mut work),
    };
    let indices = made.packed(
        (U32, "SCALAR"),
        6,
        &Packed {
            name,
            bytes: indices.unwrap(),
            stride: 4,
            mode,
            filter: "NONE",
        },
    );
    let attributes = json!({"POSITION": positions, "NORMAL": normals});
    made.primitive(json!({"attributes": attributes, "indices": indices}));
    made
}

#[test]
fn what_meshoptimizer_compressed_is_read_without_its_fallback() {
    for (name, mode) in [(EXT, "TRIANGLES"), (EXT, "INDICES"), (KHR, "TRIANGLES")] {
        let mesh = &scene(&square(name, mode)).meshes[0];
        let wanted = SQUARE.map(|it| it.map(f64::from));
        let corners = |[a, b, c]: [u32; 3]| {
            let at = |it: u32| mesh.positions[it as usize].to_array();
            let least = [[a, b, c], [b, c, a], [c, a, b]];
            least
                .map(|it| it.map(at))
                .into_iter()
                .reduce(|a, b| if b < a { b } else { a })
        };
        let found: Vec<_> = mesh
            .triangles
            .iter()
            .map(|it| corners(*it).unwrap())
            .collect();
        let [a, b, c, d] = wanted;
        assert_eq!(found, [[a, b, c], [a, c, d]], "{name} {mode}");
        for normal in &mesh.normals {
            let off = (normal[0] - 0.6).abs() + normal[1].abs() + (normal[2] - 0.8).abs();
            assert!(off < 0.03, "{normal:?}");
        }
    }
}

#[test]
fn compressed_views_that_claim_too_much_or_are_odd_are_refused() {
    let said = |change: &dyn Fn(&mut Value)| {
        let mut made = square(EXT, "TRIANGLES");
        change(&mut made.json["bufferViews"][0]);
        refusal(&made.glb())
    };
    type Change = fn(&mut Value);
    let changes: [(Change, &str); 6] = [
        (
            |view| view["byteLength"] = json!(47),
            "has 47 bytes, but 4 elements of 12",
        ),
        (
            |view| {
                view["byteLength"] = json!(12_000_000_000u64);
                view["extensions"][EXT]["count"] = json!(1_000_000_000);
            },
            "12000000000 bytes are too many",
        ),
        (
            |view| view["extensions"][EXT]["mode"] = json!("ODD"),
            "mode ODD",
        ),
        (
            |view| view["extensions"][EXT]["filter"] = json!("ODD"),
            "filter ODD",
        ),
        (
            |view| view["extensions"][EXT]["byteOffset"] = json!(1),
            "not as meshoptimizer",
        ),
        (
            |view| view["extensions"][EXT]["buffer"] = json!(1),
            "buffer 1: has no uri",
        ),
    ];
    for (change, what) in changes {
        let said = said(&change);
        assert!(said.contains(what) && said.contains("; "), "{said}");
    }
}

/// A square that Draco compressed, with numbers of its attributes there that are not those of
/// glTF.
fn draco() -> Made {
    let mut mesh = Mesh::new();
    let kinds = [
        GeometryAttributeType::Normal,
        GeometryAttributeType::Position,
    ];
    let values = [[[0.0, 0.0, 1.0]; 4], SQUARE];
    for (kind, values) in kinds.into_iter().zip(values) {
        let mut attribute = PointAttribute::new();
        attribute.init(kind, 3, DataType::Float32, false, 4);
        let bytes = f32_bytes(values.as_flattened());
        attribute.buffer_mut().write(0, &bytes);
        mesh.add_attribute(attribute);
    }
    mesh.set_num_faces(2);
    for (face, corners) in (0..).zip(INDICES.as_chunks::<3>().0) {
        mesh.set_face(FaceIndex(face), corners.map(Into::into));
    }
    let mut options = EncoderOptions::new();
    options.set_attribute_int(1, "quantization_bits", 14);
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    encoder.encode(&options, &mut buffer).unwrap();
    let mut made = Made::empty();
    made.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let view = made.view(buffer.data());
    for count in [4, 4] {
        made.push(
            "accessors",
            json!({"componentType": F32, "type": "VEC3", "count": count}),
        );
    }
    made.push(
        "accessors",
        json!({"componentType": U32, "type": "SCALAR", "count": 6}),
    );
    made.primitive(json!({
        "attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2,
        "extensions": {"KHR_draco_mesh_compression": {
            "bufferView": view, "attributes": {"POSITION": 1, "NORMAL": 0},
        }},
    }));
    made
}

#[test]
fn what_draco_compressed_is_read() {
    let mesh = &scene(&draco()).meshes[0];
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 2));
    let area = |[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|it| mesh.positions[*it as usize]);
        (b - a).cross(c - a) / 2.0
    };
    let area: glam::DVec3 = mesh.triangles.iter().map(area).sum();
    assert!(area.distance(glam::DVec3::Z) < 1e-3, "{area}");
    assert!(mesh.normals.iter().all(|it| it[2] > 0.99));
}

#[test]
fn parts_that_draco_did_not_compress_so_are_refused() {
    let said = |change: &dyn Fn(&mut Value)| {
        let mut made = draco();
        change(&mut made.json["meshes"][0]["primitives"][0]["extensions"]);
        refusal(&made.glb())
    };
    let name = "KHR_draco_mesh_compression";
    let odd = said(&|it| it[name]["attributes"]["POSITION"] = json!(9));
    assert!(
        odd.contains("mesh 0, primitive 0: names attribute 9"),
        "{odd}"
    );
    let odd = said(&|it| it[name]["bufferView"] = json!(9));
    assert!(odd.contains("buffer view 9"), "{odd}");
    let mut made = draco();
    made.binary.fill(7);
    let odd = refusal(&made.glb());
    assert!(odd.contains("not as Draco writes them"), "{odd}");
}

#[test]
fn no_cut_and_no_flip_of_a_compressed_byte_panics() {
    for made in [square(EXT, "TRIANGLES"), square(KHR, "INDICES"), draco()] {
        cut_and_flip(SceneFormat::Gltf, &made.glb());
    }
}
