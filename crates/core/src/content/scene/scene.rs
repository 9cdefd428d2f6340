//! Where do the units of a scene stand in the world?

use super::description::{SceneObject, most_growth};
use super::pack::ScenePack;
use super::sight::Sphere;
use super::unit_table::{OF_ALL, UnitRow};
use crate::pack::unit::UnitId;
use crate::units::Radians;
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use std::sync::Arc;

/// What is lower than this share of its width lies flat.
const FLATNESS: f64 = 0.25;
/// How far an eye is raised to see what lies flat.
const FLAT_RISE: Radians = Radians(40.0 * core::f64::consts::PI / 180.0);

/// A scene: its pack, and where its units are in the world.
#[derive(Debug)]
pub struct Scene {
    pub(super) name: String,
    pack: Arc<ScenePack>,
    /// For each place where a unit stands: its sphere and the error of what it is shown in place
    /// of, in metres.
    stands: Vec<Stand>,
    /// First of `stands` of each unit, and their number at the end.
    first: Vec<u32>,
    bounds: Sphere,
}

/// A unit in one of the places where its object stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stand {
    pub(super) sphere: Sphere,
    pub(super) error: f64,
    /// Length of a side of the triangles that it is shown in place of, about; of a page 0.
    pub(super) side: f64,
}

impl Scene {
    /// The scene of this pack, called `name` in logs.
    #[must_use]
    pub fn new(name: &str, pack: Arc<ScenePack>) -> Self {
        let objects = &pack.description().objects;
        let placed: Vec<Vec<(DAffine3, f64)>> = objects.iter().map(placements).collect();
        let (mut stands, mut first) = (Vec::new(), vec![0]);
        let in_world = [(DAffine3::IDENTITY, 1.0)];
        for row in pack.rows() {
            let (origin, placed) = match row.object {
                OF_ALL => (DVec3::ZERO, &in_world[..]),
                object => {
                    let object = usize::from(object);
                    let origin = DVec3::from_array(objects[object].grid.origin);
                    (origin, &placed[object][..])
                }
            };
            let centre = origin + DVec3::from_array(row.centre.map(f64::from));
            for (world_from_object, scale) in placed {
                stands.push(Stand {
                    sphere: Sphere {
                        centre: world_from_object.transform_point3(centre),
                        radius: f64::from(row.radius) * scale,
                    },
                    error: f64::from(row.error) * scale,
                    side: coarse_side(row) * scale,
                });
            }
            first.push(stands.len() as u32);
        }
        let spheres: Vec<(Sphere, f64)> = objects
            .iter()
            .zip(&placed)
            .flat_map(placed_bounds)
            .collect();
        Self {
            bounds: bounds(&without_strays(spheres)),
            name: name.to_owned(),
            stands,
            first,
            pack,
        }
    }

    /// Description, index and table of units.
    #[must_use]
    pub fn pack(&self) -> &Arc<ScenePack> {
        &self.pack
    }

    /// A sphere round all of it, but for objects with next to none of its triangles and points that
    /// stand many times as far away as all others.
    #[must_use]
    pub fn bounds(&self) -> Sphere {
        self.bounds
    }

    /// By which angle about its middle an eye is raised that is to see it at first: none, but of
    /// what lies flat, as land does, which shows nothing from the side.
    #[must_use]
    pub fn rise(&self) -> Radians {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for object in &self.pack.description().objects {
            let half = DVec3::from_array(object.bounds.half);
            if half == DVec3::ZERO {
                return Radians(0.0);
            }
            let centre = DVec3::from_array(object.bounds.centre);
            for (world_from_object, _) in placements(object) {
                let centre = world_from_object.transform_point3(centre);
                if centre.distance(self.bounds.centre) > self.bounds.radius {
                    continue;
                }
                let matrix = world_from_object.matrix3;
                let sides = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::abs);
                let reach = sides[0] * half.x + sides[1] * half.y + sides[2] * half.z;
                (low, high) = (low.min(centre - reach), high.max(centre + reach));
            }
        }
        let size = high - low;
        match size.y < FLATNESS * size.x.min(size.z) {
            true => FLAT_RISE,
            false => Radians(0.0),
        }
    }

    /// The object of a unit of a mesh.
    ///
    /// # Panics
    /// There must be such a unit.
    #[must_use]
    pub fn object_of(&self, unit: UnitId) -> &SceneObject {
        &self.pack.description().objects[usize::from(self.pack.row(unit).object)]
    }

    /// The unit that refines each cluster that one does, by the cluster's unit and number there.
    #[must_use]
    pub fn refiners(&self) -> HashMap<(UnitId, u8), UnitId> {
        self.pack.refiners()
    }

    pub(super) fn stands(&self, unit: UnitId) -> &[Stand] {
        let at = unit.0 as usize;
        &self.stands[self.first[at] as usize..self.first[at + 1] as usize]
    }
}

/// Length of a side of the triangles that a unit is shown in place of: half as many as its own,
/// over a disc of its sphere. For a page, and for points, the error says all.
fn coarse_side(row: &UnitRow) -> f64 {
    if !row.kind.facts().has_triangles {
        return 0.0;
    }
    let radius = f64::from(row.radius);
    let triangles = f64::from(row.samples.max(1));
    libm::sqrt(2.0 * core::f64::consts::PI * radius * radius / triangles)
}

/// Where an object stands, and by how much lengths grow there at most.
fn placements(object: &SceneObject) -> Vec<(DAffine3, f64)> {
    let scaled = |it: DAffine3| (it, most_growth(&it));
    object.placements().map(scaled).collect()
}

/// The sphere round an object, wherever it stands, and how many triangles and points it has.
fn placed_bounds((object, placed): (&SceneObject, &Vec<(DAffine3, f64)>)) -> Vec<(Sphere, f64)> {
    let centre = DVec3::from_array(object.bounds.centre);
    let samples = object.shape.samples() as f64;
    let at = |(world_from_object, scale): &(DAffine3, f64)| {
        let sphere = Sphere {
            centre: world_from_object.transform_point3(centre),
            radius: object.bounds.radius * scale,
        };
        (sphere, samples)
    };
    placed.iter().map(at).collect()
}

/// Leaves out spheres with next to none of all samples that reach many times as far as all others
/// together.
fn without_strays(spheres: Vec<(Sphere, f64)>) -> Vec<Sphere> {
    /// What may be left out, of all samples.
    const FEW: f64 = 0.02;
    /// How many times as far.
    const FAR: f64 = 16.0;
    let all: f64 = spheres.iter().map(|it| it.1).sum();
    let middle = DVec3::from_array([0, 1, 2].map(|axis| {
        let mut along: Vec<(f64, f64)> = spheres
            .iter()
            .map(|(sphere, samples)| (sphere.centre[axis], *samples))
            .collect();
        along.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = 0.0;
        let half = along.iter().find(|(_, samples)| {
            sum += samples;
            2.0 * sum >= all
        });
        half.map_or(0.0, |it| it.0)
    }));
    let reach = |sphere: &Sphere| sphere.centre.distance(middle) + sphere.radius;
    let mut outwards: Vec<(f64, f64)> = spheres
        .iter()
        .map(|(sphere, samples)| (reach(sphere), *samples))
        .collect();
    outwards.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let most = outwards.iter().find(|(_, samples)| {
        sum += samples;
        sum >= (1.0 - FEW) * all
    });
    let most = FAR * most.map_or(f64::INFINITY, |it| it.0);
    let kept = spheres.into_iter().map(|it| it.0);
    kept.filter(|it| reach(it) <= most).collect()
}

/// A sphere round spheres: round the middle of the box that they fill.
fn bounds(spheres: &[Sphere]) -> Sphere {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for Sphere { centre, radius } in spheres {
        low = low.min(centre - DVec3::splat(*radius));
        high = high.max(centre + DVec3::splat(*radius));
    }
    let centre = (low + high) / 2.0;
    let reach = spheres
        .iter()
        .map(|it| (it.centre - centre).length() + it.radius);
    Sphere {
        centre,
        radius: reach.fold(0.0, f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(x: f64, radius: f64) -> Sphere {
        let centre = DVec3::new(x, 0.0, 0.0);
        Sphere { centre, radius }
    }

    #[test]
    fn what_is_far_and_little_is_not_framed() {
        let near = [(sphere(0.0, 50.0), 9000.0), (sphere(200.0, 50.0), 1000.0)];
        let all = |more: &[(Sphere, f64)]| without_strays([&near[..], more].concat());
        let radius = bounds(&all(&[])).radius;
        let sky = (sphere(0.0, 1e5), 80.0);
        let stray = (sphere(3e4, 1.0), 1.0);
        assert_eq!(bounds(&all(&[sky, stray])).radius, radius);
        // Neither what is not so far nor what has much of it is left out.
        assert_eq!(all(&[(sphere(2e3, 50.0), 1.0)]).len(), 3);
        assert_eq!(all(&[(sphere(3e4, 50.0), 1000.0)]).len(), 3);
        assert_eq!(without_strays(vec![(sphere(5.0, 0.0), 0.0)]).len(), 1);
    }
}
