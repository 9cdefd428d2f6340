//! Do signatures measure what units add?

use super::meshes::{all_meshes, sheet, torus};
use super::{built, full_cut};
use crate::build::{BuildOptions, Built, build};
use crate::signatures::StepMeasure;
use crate::source::SourceScene;
use foveal_core::content::mesh::octahedral::{
    direction_from_octahedral, octahedral_from_direction,
};
use foveal_core::content::mesh::payload::MeshVertex;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::content::scene::lighting::LAMP_DIRECTION;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::measures::contrast::Signature;
use glam::DVec3;

/// What a unit is shown in place of, and what it shows; of a root nothing.
type Step = [Vec<[MeshVertex; 3]>; 2];

fn steps(built: &Built) -> Vec<Step> {
    let cut = full_cut(built);
    let step = |number: usize| {
        let placed = |unit| cut.unit(unit).unwrap();
        let row = &built.units[number].row;
        let replaced = row.replaces.iter();
        let before = replaced.flat_map(|it| {
            let unit = placed(row.needs[usize::from(it.need)]);
            unit.triangles(usize::from(it.part))
        });
        let unit = placed(UnitId(number as u32));
        let after = (0..unit.clusters.len()).flat_map(|it| unit.triangles(it));
        [before.collect(), after.collect()]
    };
    (0..built.units.len()).map(step).collect()
}

fn measured(object: &SceneObject, step: &Step, pixel: f64) -> Signature {
    StepMeasure::new(object, LAMP_DIRECTION).signature(step.each_ref().map(|it| &it[..]), pixel)
}

fn differences(signature: &Signature) -> [f64; 3] {
    signature.bands.map(|it| it.difference)
}

/// A sheet without waves whose vertices have colours in squares, of so much light or none.
fn checker(side: u32, light: f32) -> SourceScene {
    let mut source = sheet(side);
    let mesh = &mut source.meshes[0];
    for at in &mut mesh.positions {
        at.y = 0.0;
    }
    let square = |at: &DVec3| ((at.x * 12.0).floor() + (at.z * 12.0).floor()) % 2.0 == 0.0;
    let colour = |at| if square(at) { [light; 4] } else { [0.2; 4] };
    mesh.colours = mesh.positions.iter().map(colour).collect();
    source
}

#[test]
fn a_signature_is_that_of_the_step_at_a_pixel_of_error() {
    for (name, source) in all_meshes() {
        let built = built(&source);
        for (unit, step) in built.units.iter().zip(steps(&built)) {
            let row = &unit.row;
            let object = &built.objects[usize::from(row.object)];
            let expected = match row.needs.is_empty() {
                true => Signature::default(),
                false => measured(object, &step, f64::from(row.error)),
            };
            // Payloads may begin a triangle with another corner, which is rounded otherwise.
            let told = row.signature.bands.iter().zip(&expected.bands);
            for (told, expected) in told {
                let off = (told.difference - expected.difference).abs();
                assert!(off < 1e-9, "{name}");
            }
        }
    }
}

#[test]
fn a_build_without_signatures_differs_in_nothing_else() {
    let source = torus(64, 32);
    let options = BuildOptions {
        signatures: false,
        ..Default::default()
    };
    let without = build(&source, &options, &|_, _| ()).unwrap();
    let mut with = built(&source);
    assert_ne!(with, without);
    for unit in &mut with.units {
        unit.row.signature = Signature::default();
    }
    assert_eq!(with, without);
}

#[test]
fn colours_on_a_flat_sheet_add_contrast_and_one_colour_adds_none() {
    let most = |source: &SourceScene| {
        let built = built(source);
        let units = built.units.iter();
        let all = units.flat_map(|it| differences(&it.row.signature));
        all.fold(0.0, f64::max)
    };
    assert!(most(&checker(60, 0.8)) > 0.05);
    assert!(most(&checker(60, 0.2)) < 1e-12);
}

#[test]
fn finer_levels_add_less_at_equal_pixels() {
    let built = built(&torus(192, 96));
    let steps = steps(&built);
    let mean = |level: u8| {
        let units = built.units.iter().zip(&steps);
        let units = units.filter(|(unit, _)| unit.level == level);
        let each = units.map(|(_, step)| differences(&measured(&built.objects[0], step, 0.04)));
        let each: Vec<f64> = each.map(|it| it.iter().sum()).collect();
        each.iter().sum::<f64>() / each.len() as f64
    };
    let means: Vec<f64> = (0..6).map(mean).collect();
    assert!(means.is_sorted(), "{means:?}");
    assert!(means[5] > 5.0 * means[0], "{means:?}");
}

/// A vertex of an object that is turned by a quarter about an axis, on a grid of so many places.
fn turned(axis: usize, last: u16, vertex: MeshVertex) -> MeshVertex {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (mut place, mut normal) = (vertex.place, direction_from_octahedral(vertex.normal));
    let was = (place, normal);
    (place[u], place[v]) = (last - was.0[v], was.0[u]);
    (normal[u], normal[v]) = (-was.1[v], was.1[u]);
    MeshVertex {
        place,
        normal: octahedral_from_direction(normal),
        ..vertex
    }
}

#[test]
fn how_axes_lie_changes_nothing_but_rounding() {
    for (name, source) in all_meshes().into_iter().take(4) {
        let built = built(&source);
        let object = &built.objects[0];
        for step in steps(&built) {
            for axis in 0..3 {
                let turn = |it: MeshVertex| turned(axis, (1 << 14) - 1, it);
                let turned = step.each_ref().map(|it| {
                    let triangles = it.iter().map(|corners| corners.map(turn));
                    triangles.collect::<Vec<_>>()
                });
                // The object stands in the world as before.
                let mut columns = [[0.0; 3]; 3];
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                (columns[axis][axis], columns[u][v], columns[v][u]) = (1.0, -1.0, 1.0);
                let mut placed = object.clone();
                placed.placements[0][..9].copy_from_slice(columns.as_flattened());
                // So wide that all is drawn: samples of other sides lie elsewhere.
                let places = step.iter().flatten().flatten().flat_map(|it| it.place);
                let reach = places.clone().max().unwrap_or(0) - places.min().unwrap_or(0);
                let pixel = f64::from(reach) / 30.3 * object.grid.step;
                let [before, after] = [
                    measured(object, &step, pixel),
                    measured(&placed, &turned, pixel),
                ];
                for (before, after) in differences(&before).into_iter().zip(differences(&after)) {
                    let off = (before - after).abs();
                    assert!(off < 0.05 * before + 0.001, "{name} {before} {after}");
                }
            }
        }
    }
}

#[test]
fn no_error_is_too_small_or_too_large() {
    let built = built(&torus(48, 24));
    let steps = steps(&built);
    for pixel in [
        0.0,
        1e-300,
        1e-30,
        1e-6,
        1e3,
        1e30,
        f64::MAX,
        f64::INFINITY,
        f64::NAN,
    ] {
        for step in &steps {
            let told = measured(&built.objects[0], step, pixel).bands;
            let told = told
                .iter()
                .flat_map(|it| [it.before, it.after, it.difference, it.norm]);
            assert!(
                told.into_iter().all(|it| (0.0..100.0).contains(&it)),
                "{pixel}"
            );
        }
    }
    let none = measured(&built.objects[0], &Step::default(), 1.0);
    assert_eq!(none, Signature::default());
}
