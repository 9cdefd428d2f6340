//! Where do the cubes of points stand before the eye?

use crate::points::params::{CubeParams, NONE};
use crate::points::units::CloudUnits;
use crate::scene::params::in_view;
use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::scene::description::SceneObject;
use foveal_core::pack::unit::UnitId;
use foveal_core::view::eye_view::EyeView;
use glam::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;

/// Parts of a side of a cube.
const PARTS: f64 = 65536.0;

/// A unit in one of the places where its object stands.
pub(crate) struct StandingCube {
    pub(crate) unit: UnitId,
    /// World from places in the cube, in 65536ths of a side.
    world_from_cube: DAffine3,
    spacing: f32,
    level: u32,
    octants: [u32; 8],
    refiners: [u32; 8],
}

/// Every unit that is there in every place where it stands, as a list.
pub(crate) fn standing(units: &CloudUnits, objects: &[SceneObject]) -> Vec<StandingCube> {
    let mut number_of: HashMap<UnitId, u32> = HashMap::new();
    let mut next = 0;
    for (unit, note, _) in units.all() {
        number_of.insert(unit, next);
        next += objects[usize::from(note.object)].placements.len() as u32;
    }
    let mut cubes = Vec::with_capacity(next as usize);
    for (unit, note, placed) in units.all() {
        let object = &objects[usize::from(note.object)];
        let Some(cloud) = units.cloud(note.object) else {
            continue;
        };
        let object_from_cube = object_from_cube(cloud, placed.corner, placed.bits);
        let step = cloud.scale.into_iter().fold(0.0, f64::max);
        for (place, world_from_object) in (0..).zip(object.placements()) {
            let octant = |child: Option<UnitId>| {
                let number = child.and_then(|child| number_of.get(&child));
                number.map_or(NONE, |it| it + place)
            };
            let refiner = |octant: u8| units.refiner(unit, octant).map_or(NONE, |it| it.0);
            cubes.push(StandingCube {
                unit,
                world_from_cube: world_from_object * object_from_cube,
                spacing: (step * placed.cell_steps as f64 * scale_of(&world_from_object)) as f32,
                level: u32::from(note.level),
                octants: placed.refined_by.map(octant),
                refiners: [0, 1, 2, 3, 4, 5, 6, 7].map(refiner),
            });
        }
    }
    cubes
}

fn object_from_cube(cloud: &Cloud, corner: [u32; 3], bits: u8) -> DAffine3 {
    let part = 2_f64.powi(i32::from(bits)) / PARTS;
    let scale = DMat3::from_diagonal(DVec3::from_array(cloud.scale) * part);
    DAffine3::from_mat3_translation(scale, cloud.at(corner))
}

/// By how much lengths grow, about.
fn scale_of(world_from_object: &DAffine3) -> f64 {
    world_from_object.matrix3.determinant().abs().cbrt()
}

impl StandingCube {
    /// As `view` sees it. Differences of places are taken in `f64`.
    pub(crate) fn seen_by(&self, view: &EyeView) -> CubeParams {
        let DAffine3 {
            matrix3,
            translation,
        } = self.world_from_cube;
        let axes = [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis];
        let [x, y, z] = axes.map(|it| in_view(view, it));
        let origin = in_view(view, translation - view.position);
        let row = |k: usize| [x[k], y[k], z[k], origin[k]].map(|it| it as f32);
        CubeParams {
            view_from_cube: [0, 1, 2].map(row),
            spacing: self.spacing,
            level: self.level,
            unused_pair: [0; 2],
            octants: self.octants,
            refiners: self.refiners,
        }
    }

    /// Whether a view shows any of it, with the squares of its points.
    pub(crate) fn is_in_view(&self, view: &EyeView, near: f64) -> bool {
        let middle = self
            .world_from_cube
            .transform_point3(DVec3::splat(PARTS / 2.0));
        let matrix = self.world_from_cube.matrix3 * (PARTS / 2.0);
        let reach = matrix.x_axis.abs() + matrix.y_axis.abs() + matrix.z_axis.abs();
        let radius = reach.length() + 2.0 * f64::from(self.spacing);
        let at = in_view(view, middle - view.position);
        let field = view.field;
        let planes = [
            DVec3::new(1.0, 0.0, field.left),
            DVec3::new(-1.0, 0.0, field.right),
            DVec3::new(0.0, 1.0, field.up),
            DVec3::new(0.0, -1.0, field.down),
        ];
        // A pixel outside the view: a square is never smaller.
        let beside = |plane: &DVec3| plane.dot(at) < -(radius + 0.01 * at.z.abs()) * plane.length();
        at.z + radius >= near && !planes.iter().any(beside)
    }
}
