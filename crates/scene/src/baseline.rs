//! What does meshoptimizer by itself make of a mesh, for comparison?

use crate::source::{SourceMesh, SourceScene};
use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::{Attributes, MeshUnit, MeshVertex};
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use std::collections::HashMap;

/// Triangles of a cluster, and clusters of a group, as builds have them.
const CLUSTER: usize = 64;
const GROUP: usize = 4;

/// Builds every mesh of a scene in clusters and groups of our sizes, by meshoptimizer's own
/// clusterlod, and returns the number of groups; nothing is put on a grid or encoded.
#[must_use]
pub fn clod_build(source: &SourceScene) -> usize {
    source.meshes.iter().map(clod_groups).sum()
}

fn clod_groups(mesh: &SourceMesh) -> usize {
    let positions = mesh.positions.iter().map(|it| it.as_vec3().to_array());
    let positions: Vec<[f32; 3]> = positions.collect();
    let bytes = meshopt::typed_to_bytes(&positions[..]);
    let Ok(vertices) = meshopt::VertexDataAdapter::new(bytes, 12, 0) else {
        return 0;
    };
    let mut config = meshopt::clod_default_config(CLUSTER);
    config.partition_size = GROUP;
    let mesh = meshopt::ClodMesh::new(mesh.triangles.as_flattened(), &vertices);
    let mut groups = 0;
    meshopt::clod_build(config, &mesh, |_, _| {
        groups += 1;
        groups - 1
    });
    groups as usize
}

/// The finest level of an object as one mesh, each vertex once.
#[derive(Clone, Debug, Default)]
pub struct FinestMesh {
    /// What its vertices have.
    pub attributes: Attributes,
    /// Its vertices, on the grid of the object.
    pub vertices: Vec<MeshVertex>,
    /// Its triangles, by numbers of vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// The finest level of every object, whose units' rows and payloads are given.
///
/// # Errors
/// A payload is not there, or does not fit to those it needs.
pub fn finest_meshes<E: From<PackError>>(
    rows: &[UnitRow],
    attributes: &[Attributes],
    payload_of: &mut dyn FnMut(UnitId) -> Result<MeshUnit, E>,
) -> Result<Vec<FinestMesh>, E> {
    let mut cut = MeshCut::default();
    for (unit, row) in (0..).map(UnitId).zip(rows) {
        cut.insert(unit, &row.needs, &payload_of(unit)?)?;
    }
    let empty = |attributes: &Attributes| FinestMesh {
        attributes: *attributes,
        ..FinestMesh::default()
    };
    let mut meshes: Vec<FinestMesh> = attributes.iter().map(empty).collect();
    let mut numbers: Vec<HashMap<MeshVertex, u32>> = vec![HashMap::new(); meshes.len()];
    for (unit, placed, cluster) in cut.drawn() {
        let object = usize::from(rows[unit.0 as usize].object);
        let (mesh, numbers) = (&mut meshes[object], &mut numbers[object]);
        let triangles = placed.triangles(cluster).map(|corners| {
            corners.map(|vertex| {
                *numbers.entry(vertex).or_insert_with(|| {
                    mesh.vertices.push(vertex);
                    mesh.vertices.len() as u32 - 1
                })
            })
        });
        mesh.triangles.extend(triangles);
    }
    Ok(meshes)
}

/// A mesh as meshoptimizer's codecs for whole meshes write it, at one rate.
#[derive(Clone, Debug)]
pub struct WholeMesh {
    indices: usize,
    encoded_indices: Vec<u8>,
    vertex_bytes: usize,
}

impl WholeMesh {
    /// Encodes a mesh, in the order in which that codec writes least.
    ///
    /// # Errors
    /// The codec refuses it.
    pub fn encode(mesh: &FinestMesh) -> Result<Self, meshopt::Error> {
        let count = mesh.vertices.len();
        let mut indices = meshopt::optimize_vertex_cache(mesh.triangles.as_flattened(), count);
        let vertices = meshopt::optimize_vertex_fetch(&mut indices, &mesh.vertices);
        let Attributes {
            normals, colours, ..
        } = mesh.attributes;
        let attributes = usize::from(normals) + usize::from(colours);
        let vertex_bytes = match attributes {
            0 => vertex_bytes::<8>(&vertices, mesh.attributes),
            1 => vertex_bytes::<12>(&vertices, mesh.attributes),
            _ => vertex_bytes::<16>(&vertices, mesh.attributes),
        }?;
        Ok(Self {
            indices: indices.len(),
            encoded_indices: meshopt::encode_index_buffer(&indices, count)?,
            vertex_bytes,
        })
    }

    /// Bytes of vertices and triangles.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.encoded_indices.len() + self.vertex_bytes
    }

    /// Decodes the triangles and returns their number.
    ///
    /// # Errors
    /// None of what was encoded here.
    pub fn decode_triangles(&self) -> Result<usize, meshopt::Error> {
        let indices = meshopt::decode_index_buffer::<u32>(&self.encoded_indices, self.indices)?;
        Ok(indices.len() / 3)
    }
}

/// Bytes of vertices of so many bytes each, encoded.
fn vertex_bytes<const SIZE: usize>(
    vertices: &[MeshVertex],
    attributes: Attributes,
) -> Result<usize, meshopt::Error>
where
    [u8; SIZE]: Clone + Default,
{
    let raw = vertices.iter().map(|vertex| {
        let mut bytes = [0; SIZE];
        let [x, y, z] = vertex.place.map(u16::to_le_bytes);
        let place = [x, y, z, [0; 2]];
        let normal = [vertex.normal.map(|it| it as u8), [0; 2]];
        let told = attributes.normals.then_some(normal.as_flattened());
        let colour = attributes.colours.then_some(&vertex.colour[..]);
        let all = [Some(place.as_flattened()), told, colour];
        let all = all.into_iter().flatten().flatten();
        bytes.iter_mut().zip(all).for_each(|(to, from)| *to = *from);
        bytes
    });
    let raw: Vec<[u8; SIZE]> = raw.collect();
    Ok(meshopt::encode_vertex_buffer(&raw)?.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::{BuildOptions, build};
    use crate::generate::{alone, torus};

    #[test]
    fn the_finest_mesh_has_the_triangles_of_the_source_and_is_encoded_and_decoded() {
        let source = alone("torus", torus(64, 32));
        let built = build(&source, &BuildOptions::default(), &|_, _| ()).unwrap();
        let rows: Vec<UnitRow> = built.units.iter().map(|it| it.row.clone()).collect();
        let attributes = [built.objects[0].attributes];
        let mut payload_of = |unit: UnitId| {
            let unit = &built.units[unit.0 as usize];
            MeshUnit::parse(&unit.payload, attributes[0], &unit.row.replaces)
        };
        let meshes = finest_meshes::<PackError>(&rows, &attributes, &mut payload_of).unwrap();
        assert_eq!(meshes[0].triangles.len(), source.meshes[0].triangles.len());
        assert_eq!(meshes[0].vertices.len(), source.meshes[0].positions.len());
        let whole = WholeMesh::encode(&meshes[0]).unwrap();
        assert_eq!(whole.decode_triangles().unwrap(), 4096);
        assert!(whole.bytes() > 4096 && whole.bytes() < 4096 * 10);
        assert!(clod_build(&source) > 10);
    }
}
