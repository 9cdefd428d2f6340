//! What do views of glTF buffers say that meshoptimizer compressed?
//!
//! Source: Khronos, "EXT_meshopt_compression" and "KHR_meshopt_compression".

use meshoptimizer_rs::codec::{
    decode_filter_color, decode_filter_exp, decode_filter_oct, decode_filter_quat,
    decode_index_buffer, decode_index_sequence, decode_vertex_buffer,
};
use meshoptimizer_rs::{Error, Workspace};

use super::super::error::Fault;
use super::super::mends::{Mends, PACKED_LEFT};
use super::super::text::shortened;
use super::buffers::Buffers;
use super::json::{Document, MeshoptView, View};

/// Puts what they say in place of views that are compressed; of those that cannot be unpacked,
/// nothing.
pub(super) fn unpack(document: &mut Document, buffers: &mut Buffers<'_>, mends: &mut Mends) {
    let mut workspace = Workspace::default();
    for number in 0..document.buffer_views.len() {
        let Some(said) = document.buffer_views[number].extensions.meshopt().cloned() else {
            continue;
        };
        let unpacked = unpacked(document, number, &said, buffers, &mut workspace);
        let buffer = unpacked.unwrap_or_else(|fault| {
            let what = fault.clone().what();
            mends.add(PACKED_LEFT, 1, || format!("is {what}"));
            buffers.add_lost(fault)
        });
        let view = &mut document.buffer_views[number];
        (view.buffer, view.byte_offset) = (buffer, 0);
    }
}

/// The number of a buffer of what a compressed view says.
fn unpacked(
    document: &Document,
    number: usize,
    said: &MeshoptView,
    buffers: &mut Buffers<'_>,
    workspace: &mut Workspace,
) -> Result<u32, Fault> {
    let place = || format!("buffer view {number}");
    let source = View {
        buffer: said.buffer,
        byte_offset: said.byte_offset,
        byte_length: said.byte_length,
        ..View::default()
    };
    let bytes = said.count.saturating_mul(said.byte_stride);
    let told = document.buffer_views[number].byte_length;
    if told != bytes {
        let (count, stride) = (said.count, said.byte_stride);
        let what = format!("has {told} bytes, but {count} elements of {stride} compressed");
        return Err(Fault::at(place(), what));
    }
    buffers.allow(bytes, &place())?;
    let unpacked = decoded(said, buffers.part(&source, &place)?, workspace);
    let unpacked = unpacked.map_err(|what| Fault::at(place(), what))?;
    Ok(buffers.add(unpacked))
}

/// The bytes of a compressed view.
fn decoded(said: &MeshoptView, source: &[u8], work: &mut Workspace) -> Result<Vec<u8>, String> {
    let whole = |number| usize::try_from(number).map_err(|_| format!("{number} is too many"));
    let [count, stride] = [whole(said.count)?, whole(said.byte_stride)?];
    let filter = said.filter.as_deref().unwrap_or("NONE");
    let unpacked = match (said.mode.as_str(), filter) {
        ("ATTRIBUTES", _) => decode_vertex_buffer(count, stride, source, work),
        ("TRIANGLES", "NONE") => decode_index_buffer(count, stride, source, work),
        ("INDICES", "NONE") => decode_index_sequence(count, stride, source, work),
        (mode, filter) => {
            let [mode, filter] = [mode, filter].map(shortened);
            return Err(format!("is compressed by mode {mode} with filter {filter}"));
        }
    };
    let mut bytes = unpacked.map_err(refused)?;
    let filtered = match filter {
        "NONE" => Ok(()),
        "OCTAHEDRAL" => decode_filter_oct(&mut bytes, count, stride, work),
        "QUATERNION" => decode_filter_quat(&mut bytes, count, stride, work),
        "EXPONENTIAL" => decode_filter_exp(&mut bytes, count, stride, work),
        "COLOR" => decode_filter_color(&mut bytes, count, stride, work),
        other => return Err(format!("is compressed with filter {}", shortened(other))),
    };
    filtered.map_err(refused)?;
    Ok(bytes)
}

fn refused(error: Error) -> String {
    format!("its compressed bytes are not as meshoptimizer writes them: {error}")
}
