//! Which small packs of scenes are there to be damaged? Also the seed of a fuzz target.

#![allow(clippy::unwrap_used, dead_code)]

use foveal_core::content::mesh::payload::{Attributes, Cluster, MeshUnit, MeshVertex};
use foveal_core::content::scene::description::{
    Grid, KIND, ObjectBounds, SceneDescription, SceneObject, SceneSource, Shape,
};
use foveal_core::content::scene::pack::{begin_scene, chunk_name, finish_scene};
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::HEADER_BYTES;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::measures::contrast::Signature;

/// A square of two triangles, and the same with a vertex in its middle.
pub(crate) fn units() -> [(UnitRow, MeshUnit); 2] {
    let vertex = |place: [u16; 3]| MeshVertex {
        place,
        normal: [0, 127],
        colour: [0; 4],
        ..MeshVertex::default()
    };
    let corners = [[0, 0, 0], [1000, 0, 0], [1000, 1000, 0], [0, 1000, 0]];
    let square = Cluster {
        vertices: vec![0, 1, 2, 3],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let fan = Cluster {
        vertices: vec![0, 1, 2, 3, 4],
        triangles: vec![[0, 1, 4], [4, 1, 2], [4, 2, 3], [4, 3, 0]],
    };
    let root = MeshUnit {
        vertices: corners.map(vertex).to_vec(),
        clusters: vec![square],
        ..MeshUnit::default()
    };
    let finer = MeshUnit {
        replaces: vec![PartRef { need: 0, part: 0 }],
        staying: 4,
        vertices: vec![vertex([500, 500, 20])],
        clusters: vec![fan],
    };
    let row = |error, samples, vertices, needs| UnitRow {
        centre: [0.5, 0.5, 0.0],
        radius: 1.0,
        error,
        samples,
        vertices,
        needs,
        ..UnitRow::default()
    };
    [
        (row(f32::INFINITY, 2, 4, vec![]), root),
        (
            UnitRow {
                signature: Signature::from_bytes([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]),
                replaces: finer.replaces.clone(),
                ..row(0.03125, 4, 5, vec![UnitId(0)])
            },
            finer,
        ),
    ]
}

/// What the vertices of these units have.
pub(crate) const ATTRIBUTES: Attributes = Attributes {
    normals: true,
    colours: false,
    textured: false,
};

fn description() -> SceneDescription {
    let object = SceneObject {
        name: "square".to_owned(),
        shape: Shape::Mesh { leaf_triangles: 4 },
        bounds: ObjectBounds {
            centre: [0.5, 0.5, 0.0],
            radius: 1.0,
            half: [0.0; 3],
        },
        grid: Grid {
            origin: [0.0; 3],
            step: 0.001,
            bits: 10,
        },
        attributes: ATTRIBUTES,
        colour: [1.0; 4],
        two_sided: false,
        unlit: false,
        placements: vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]],
        texturing: None,
    };
    SceneDescription {
        kind: KIND.to_owned(),
        needs: vec![KIND.to_owned()],
        generator: String::new(),
        source: SceneSource::default(),
        objects: vec![object],
        textures: Vec::new(),
        parts: Vec::new(),
        joined: Default::default(),
        units: vec![1, 1],
        page: 64,
        look: Default::default(),
        identity: Default::default(),
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    }
}

/// A pack of these units; `change` may alter its description.
pub(crate) fn pack_of(change: impl Fn(&mut SceneDescription)) -> Vec<u8> {
    let mut description = description();
    change(&mut description);
    let mut builder = begin_scene(&description);
    let (mut chunks, mut rows) = (Vec::new(), Vec::new());
    for (unit, (row, says)) in (0..).map(UnitId).zip(units()) {
        let chunk = says.write(ATTRIBUTES).unwrap();
        builder.push(chunk_name(unit), &chunk);
        chunks.extend(chunk);
        rows.push(row);
    }
    let parts = finish_scene(builder, description, &rows).unwrap();
    [parts.head, chunks, parts.tail].concat()
}

/// Makes the checksums right that lie before table and units, as far as lengths allow it.
pub(crate) fn repair_checksums(pack: &mut [u8]) {
    repair_table(pack);
    let description = HEADER_BYTES..HEADER_BYTES + (word(pack, 12) as usize).min(1 << 20);
    seal(pack, description, 16);
    seal(pack, 0..60, 60);
    // Two pages, one a level; each is 16 bytes and 16 an entry.
    let mut at = word(pack, 24) as usize;
    for _ in 0..2 {
        let Some(entries) = pack.get(at + 8..at + 12) else {
            return;
        };
        let end = at + 16 + (word(entries, 0) as usize).min(64) * 16;
        let Some(body) = pack.get(at + 16..end) else {
            return;
        };
        let crc = crc32c::crc32c_append(crc32c::crc32c(&pack[at..at + 12]), body);
        pack[at + 12..at + 16].copy_from_slice(&crc.to_le_bytes());
        at = end;
    }
}

/// Makes the checksums of the table right: those of its pages, of its directory, and that of all
/// of it, which the description holds in decimal digits.
fn repair_table(pack: &mut [u8]) {
    // Two pages of index with one entry each lie before it.
    let start = (word(pack, 24) as usize).saturating_add(2 * 32);
    let Some(table) = pack.get_mut(start..).filter(|table| table.len() >= 8) else {
        return;
    };
    let pages = (word(table, 0) as usize).min(64);
    let mut at = 8 + 12 * pages;
    for page in 0..pages {
        let row = 8 + 12 * page;
        let Some(bytes) = table.get(row + 4..row + 8).map(|it| word(it, 0) as usize) else {
            return;
        };
        seal(table, at..at.saturating_add(bytes), row + 8);
        at = at.saturating_add(bytes);
    }
    seal(table, 8..8 + 12 * pages, 4);
    let crc = crc32c::crc32c(table);
    tell_in_description(pack, crc);
}

/// Writes the checksum of the table over its digits.
fn tell_in_description(pack: &mut [u8], crc: u32) {
    const KEY: &[u8] = b"\"crc32c\":";
    let Some(at) = pack.windows(KEY.len()).position(|it| it == KEY) else {
        return;
    };
    let digits = format!("{crc}}}]}}");
    let tail = &mut pack[at + KEY.len()..];
    let length = tail.iter().position(|byte| *byte == b' ').unwrap_or(0);
    if length.max(digits.len()) < tail.len() {
        tail[..length].fill(b' ');
        tail[..digits.len()].copy_from_slice(digits.as_bytes());
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

/// Writes the checksum of a part to where it belongs.
fn seal(bytes: &mut [u8], part: core::ops::Range<usize>, at: usize) {
    if let Some(part) = bytes.get(part) {
        let crc = crc32c::crc32c(part);
        if let Some(place) = bytes.get_mut(at..at + 4) {
            place.copy_from_slice(&crc.to_le_bytes());
        }
    }
}
