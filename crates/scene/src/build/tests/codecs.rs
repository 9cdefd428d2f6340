//! Does meshoptimizer in Rust, which viewers read units with, say what that in C++ says?

use super::meshes::{sphere, torus};
use super::{built, parsed};
use foveal_core::content::mesh::payload::{Cluster, MeshVertex};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{
    VertexEncoding, decode_meshlet_into, decode_vertex_buffer_into, encode_meshlet,
    encode_vertex_buffer,
};

fn streams_are_equal(cluster: &Cluster, workspace: &mut Workspace) {
    let triangles = cluster.triangles.as_flattened();
    let count = cluster.triangles.len();
    let meshlet = meshopt::Meshlet {
        vertices: &[],
        triangles,
    };
    let stream = meshopt::encode_meshlet(meshlet).unwrap();
    assert_eq!(encode_meshlet(&[], triangles, workspace).unwrap(), stream);
    let (_, theirs) = meshopt::decode_meshlet(&stream, 0, count).unwrap();
    let mut ours = vec![0; 3 * count];
    decode_meshlet_into(&mut [], 0, 2, &mut ours, count, 3, &stream, workspace).unwrap();
    assert_eq!(ours, theirs);
    assert_eq!(ours, triangles);
}

fn attributes_are_equal(vertices: &[MeshVertex], workspace: &mut Workspace) {
    let raw = vertices.iter().map(|it| {
        let [u, v] = it.normal.map(|it| it as u8);
        let [r, g, b, a] = it.colour;
        [u, v, 0, 0, r, g, b, a]
    });
    let raw: Vec<[u8; 8]> = raw.collect();
    let stream = meshopt::encode_vertex_buffer(&raw).unwrap();
    let (count, bytes) = (raw.len(), raw.as_flattened());
    let encoding = VertexEncoding::DEFAULT;
    let ours = encode_vertex_buffer(bytes, count, 8, encoding, workspace).unwrap();
    assert_eq!(ours, stream);
    let mut decoded = vec![0; bytes.len()];
    decode_vertex_buffer_into(&mut decoded, count, 8, &stream, workspace).unwrap();
    assert_eq!(decoded, bytes);
    assert_eq!(
        meshopt::decode_vertex_buffer::<[u8; 8]>(&stream, count).unwrap(),
        raw
    );
}

#[test]
fn both_codecs_write_and_read_each_stream_alike() {
    let mut workspace = Workspace::default();
    for source in [torus(96, 48), sphere(64, 32)] {
        let built = built(&source);
        for unit in (0..built.units.len()).map(|it| parsed(&built, it)) {
            let clusters = unit.clusters.iter();
            clusters.for_each(|it| streams_are_equal(it, &mut workspace));
            if !unit.vertices.is_empty() {
                attributes_are_equal(&unit.vertices, &mut workspace);
            }
        }
    }
}
