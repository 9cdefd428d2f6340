//! A scene that follows from a script, the same on every machine: for tests, and to compare a
//! browser with this machine.

use super::Scene;
use super::description::{
    Grid, KIND, ObjectBounds, SceneDescription, SceneObject, SceneSource, Shape,
};
use super::pack::{ScenePack, begin_scene, chunk_name, finish_scene};
use super::unit_table::UnitRow;
use crate::content::mesh::payload::{Attributes, Cluster, MeshUnit, MeshVertex};
use crate::pack::unit::UnitId;
use crate::pack::{HEADER_BYTES, Header, PackError};
use crate::perception::measures::contrast::{BandContrast, Signature};
use std::sync::Arc;

/// Units of each level, finest first: every one but the roots is one of four of a coarser one.
const UNITS: [u32; 4] = [128, 32, 8, 2];
/// What four units come from.
const SHARE: u32 = 4;
/// Half a side of the grid that the scene fills.
const HALF: f32 = 512.0;

/// The file of a small scene: units of a triangle each, which refine nothing that is seen, with
/// errors and spheres as a real scene has them.
///
/// # Errors
/// None: the script fits the format.
pub fn scripted_scene_file() -> Result<Vec<u8>, PackError> {
    let about = description();
    let attributes = about.objects[0].attributes;
    let mut builder = begin_scene(&about);
    let (mut rows, mut chunks): (Vec<UnitRow>, Vec<u8>) = (Vec::new(), Vec::new());
    for unit in 0..UNITS.iter().sum() {
        let row = row(unit, &rows);
        let chunk = payload(unit, &row).write(attributes)?;
        builder.push(chunk_name(UnitId(unit)), &chunk);
        chunks.extend(chunk);
        rows.push(row);
    }
    let parts = finish_scene(builder, about, &rows)?;
    Ok([parts.head, chunks, parts.tail].concat())
}

/// The same scene, opened.
///
/// # Errors
/// None: the script fits the format.
pub fn scripted_scene() -> Result<Scene, PackError> {
    let file = scripted_scene_file()?;
    let header = Header::parse(&file)?;
    let part = |from: u64, bytes: u64| &file[from as usize..(from + bytes) as usize];
    let description = part(HEADER_BYTES as u64, u64::from(header.description_bytes));
    let about = ScenePack::describe(&header, description)?;
    let table = about.units_table()?.clone();
    let index = part(header.index_offset, header.index_bytes);
    let pack = ScenePack::new(&header, about, index, part(table.offset, table.bytes))?;
    Ok(Scene::new("scripted", Arc::new(pack)))
}

fn description() -> SceneDescription {
    let object = SceneObject {
        name: "scripted".to_owned(),
        shape: Shape::Mesh {
            leaf_triangles: u64::from(UNITS[0]),
        },
        bounds: ObjectBounds {
            centre: [0.0; 3],
            radius: 1.0,
            half: [0.0; 3],
        },
        grid: Grid {
            origin: [-0.5; 3],
            step: 1.0 / f64::from(2.0 * HALF),
            bits: 10,
        },
        attributes: Attributes::default(),
        colour: [0.5, 0.5, 0.5, 1.0],
        two_sided: true,
        unlit: false,
        placements: vec![
            [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, -2.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.5, -1.0],
        ],
        texturing: None,
    };
    SceneDescription {
        kind: KIND.to_owned(),
        needs: vec![KIND.to_owned()],
        generator: "script".to_owned(),
        source: SceneSource::default(),
        objects: vec![object],
        textures: Vec::new(),
        parts: Vec::new(),
        joined: Default::default(),
        units: UNITS.to_vec(),
        page: 16,
        look: Default::default(),
        identity: Default::default(),
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    }
}

/// A number from -1 to 1 that follows from a unit's.
fn scattered(unit: u32, k: u32) -> f32 {
    let mixed = (unit * 3 + k + 1).wrapping_mul(2_654_435_761);
    (mixed >> 8) as f32 / (1 << 23) as f32 - 1.0
}

/// The row of the next unit after `before`.
fn row(unit: u32, before: &[UnitRow]) -> UnitRow {
    // Units are numbered coarsest level first.
    let (mut first, mut coarser) = (0, 0);
    for count in UNITS.iter().rev() {
        if unit < first + count {
            break;
        }
        (first, coarser) = (first + count, first);
    }
    let parent = (first > 0).then(|| coarser + (unit - first) / SHARE);
    let parent = parent.map(|it| (UnitId(it), &before[it as usize]));
    let (centre, radius) = parent.map_or(([0.5; 3], 0.25), |(_, it)| (it.centre, it.radius / 2.0));
    // Within the sphere of the coarser unit: a corner of the cube is no farther.
    let reach = if parent.is_some() { radius / 2.0 } else { 0.25 };
    let moved = |k: usize| centre[k] + reach * scattered(unit, k as u32);
    UnitRow {
        centre: [0, 1, 2].map(moved),
        radius,
        error: parent.map_or(f32::INFINITY, |_| radius / 4.0),
        signature: parent.map_or_else(Signature::default, |_| signature(unit)),
        samples: 1,
        vertices: 3,
        needs: parent.map(|(unit, _)| unit).into_iter().collect(),
        ..UnitRow::default()
    }
}

/// Some contrast in each octave.
fn signature(unit: u32) -> Signature {
    let contrast = |k: u32| f64::from(scattered(unit, k).abs()) / 4.0;
    let band = |k: u32| BandContrast {
        before: contrast(k),
        after: contrast(k + 1),
        difference: 0.01 + contrast(k + 2),
        norm: 0.02 + contrast(k + 2),
    };
    Signature {
        bands: [0, 4, 8].map(band),
    }
}

/// A triangle within the sphere of a unit.
fn payload(unit: u32, row: &UnitRow) -> MeshUnit {
    let side = row.radius / 2.0;
    let corner = |k: usize| MeshVertex {
        place: [0, 1, 2].map(|axis| {
            let off = side * scattered(unit, (3 * k + axis) as u32);
            ((row.centre[axis] + off) * 2.0 * HALF).clamp(0.0, 2.0 * HALF - 1.0) as u16
        }),
        ..MeshVertex::default()
    };
    MeshUnit {
        vertices: [0, 1, 2].map(corner).to_vec(),
        clusters: vec![Cluster {
            vertices: vec![0, 1, 2],
            triangles: vec![[0, 1, 2]],
        }],
        ..MeshUnit::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::demand::Content;

    #[test]
    fn the_script_is_a_scene_whose_spheres_enclose_each_other() {
        let scene = scripted_scene().unwrap();
        assert_eq!(scene.pack().len(), 170);
        assert_eq!(scene.base(0).len(), 2);
        for row in scene.pack().rows() {
            for need in &row.needs {
                let outer = scene.pack().row(*need);
                let apart = [0, 1, 2].map(|k| outer.centre[k] - row.centre[k]);
                let apart = apart.iter().map(|it| it * it).sum::<f32>().sqrt();
                assert!(apart + row.radius <= outer.radius, "{row:?} in {outer:?}");
                assert!(row.error <= outer.error);
            }
        }
    }
}
