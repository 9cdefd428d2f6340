//! What do parts of glTF meshes say that Draco compressed?
//!
//! Source: Khronos, "KHR_draco_mesh_compression".

use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute};
use draco_core::{DracoError, PointIndex};
use std::collections::HashMap;

use super::super::error::Fault;
use super::buffers::Buffers;
use super::json::{Accessor, Document, GltfAttributes, Primitive, View};

/// How corners of triangles are stored: unsigned, 32 bits.
const INDICES: u32 = 5125;
/// The mode of triangles.
const TRIANGLES: u32 = 4;

/// Puts accessors of what they say in place of those of parts that are compressed.
/// A part that cannot be unpacked knows why.
pub(super) fn unpack(document: &mut Document, buffers: &mut Buffers<'_>) {
    let mut known = HashMap::new();
    for mesh in 0..document.meshes.len() {
        for part in 0..document.meshes[mesh].primitives.len() {
            let place = format!("mesh {mesh}, primitive {part}");
            let said = &mut document.meshes[mesh].primitives[part];
            if said.extensions.draco.is_none() {
                continue;
            }
            let mut primitive = std::mem::take(said);
            // Parts may show the same in other materials.
            let part_of = (primitive.extensions.clone(), primitive.attributes.clone());
            match known.get(&part_of) {
                Some((attributes, indices, broken)) => {
                    primitive.attributes = GltfAttributes::clone(attributes);
                    primitive.indices = *indices;
                    primitive.mode = Some(TRIANGLES);
                    primitive.extensions.draco = None;
                    primitive.broken.clone_from(broken);
                }
                None => {
                    let done = unpack_part(document, buffers, &mut primitive, &place);
                    primitive.broken = done.err().map(Box::new);
                    let attributes = primitive.attributes.clone();
                    let unpacked = (attributes, primitive.indices, primitive.broken.clone());
                    known.insert(part_of, unpacked);
                }
            }
            document.meshes[mesh].primitives[part] = primitive;
        }
    }
}

fn unpack_part(
    document: &mut Document,
    buffers: &mut Buffers<'_>,
    primitive: &mut Primitive,
    place: &str,
) -> Result<(), Fault> {
    let Some(mut said) = primitive.extensions.draco.take() else {
        return Ok(());
    };
    let mesh = decoded(buffers.view(document, said.buffer_view)?, buffers.left());
    let mesh = mesh.map_err(|error| {
        let what = format!("its compressed bytes are not as Draco writes them: {error}");
        Fault::at(place, what)
    })?;
    let named = primitive.attributes.all().into_iter();
    for (accessor, compressed) in named.zip(said.attributes.all()) {
        let (Some(accessor), Some(compressed)) = (accessor, compressed) else {
            continue;
        };
        let Some(found) = mesh.attribute_by_unique_id(*compressed) else {
            let what = format!("names attribute {compressed} of its compressed bytes");
            return Err(Fault::at(place, format!("{what}, which is not there")));
        };
        let opened = document.accessors.get(*accessor as usize);
        let shape = opened.map_or_else(String::new, |it| it.shape.clone());
        let values = Accessor {
            component_type: component_of(found.data_type(), place)?,
            normalized: opened.is_some_and(|it| it.normalized),
            count: mesh.num_points() as u64,
            shape,
            ..Accessor::default()
        };
        let bytes = values_of(found, mesh.num_points(), place)?;
        *accessor = add(document, buffers, values, bytes, place)?;
    }
    let corners = mesh.faces().iter().flatten();
    let corners: Vec<u8> = corners.flat_map(|it| it.0.to_le_bytes()).collect();
    let indices = Accessor {
        component_type: INDICES,
        count: 3 * mesh.num_faces() as u64,
        shape: "SCALAR".to_owned(),
        ..Accessor::default()
    };
    primitive.indices = Some(add(document, buffers, indices, corners, place)?);
    primitive.mode = Some(TRIANGLES);
    Ok(())
}

/// A mesh that takes no more than `most` bytes.
fn decoded(bytes: &[u8], most: u64) -> Result<Mesh, DracoError> {
    let limits = DecodeLimits::default()
        .with_max_points(most / 4)
        .with_max_faces(most / 12)
        .with_max_decoded_bytes(most);
    let mut mesh = Mesh::new();
    let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
    MeshDecoder::new().decode(&mut buffer, &mut mesh)?;
    Ok(mesh)
}

/// The code of a kind of number in glTF.
fn component_of(kind: DataType, place: &str) -> Result<u32, Fault> {
    Ok(match kind {
        DataType::Int8 => 5120,
        DataType::Uint8 => 5121,
        DataType::Int16 => 5122,
        DataType::Uint16 => 5123,
        DataType::Uint32 => 5125,
        DataType::Float32 => 5126,
        other => {
            let what =
                format!("its compressed numbers are of kind {other:?}, which does not exist");
            return Err(Fault::at(place, what));
        }
    })
}

/// The values of all points, one after another.
fn values_of(attribute: &PointAttribute, points: usize, place: &str) -> Result<Vec<u8>, Fault> {
    let width = attribute.data_type().byte_length() * usize::from(attribute.num_components());
    let stride = usize::try_from(attribute.byte_stride()).unwrap_or(usize::MAX);
    let data = attribute.buffer().data();
    let mut values = Vec::with_capacity(points.saturating_mul(width).min(data.len()));
    for point in 0..points as u32 {
        let at = (attribute.mapped_index(PointIndex(point)).0 as usize).saturating_mul(stride);
        let value = data.get(at..at.saturating_add(width)).ok_or_else(|| {
            let what = format!("point {point} of its compressed bytes has no value");
            Fault::at(place, what)
        })?;
        values.extend(value);
    }
    Ok(values)
}

/// Adds an accessor of bytes, and gives its number.
fn add(
    document: &mut Document,
    buffers: &mut Buffers<'_>,
    accessor: Accessor,
    bytes: Vec<u8>,
    place: &str,
) -> Result<u32, Fault> {
    buffers.allow(bytes.len() as u64, place)?;
    document.buffer_views.push(View {
        byte_length: bytes.len() as u64,
        buffer: buffers.add(bytes),
        ..View::default()
    });
    document.accessors.push(Accessor {
        buffer_view: Some(document.buffer_views.len() as u32 - 1),
        ..accessor
    });
    Ok(document.accessors.len() as u32 - 1)
}
