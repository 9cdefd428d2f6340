//! How does a cloud of points become units?
//!
//! As an octree that adds: a unit holds at most 8,192 points of a cube, evenly spread, and those of
//! its octants hold the others. While only some are there, each stands for those round it, in their
//! mean colour; what is missing to its own comes with the unit of the octant that it lies in.

mod colours;
mod octree;
mod signature;
mod stretches;
#[cfg(test)]
mod tests;

use super::built::{BuildError, BuiltUnit};
use super::joined::Graphed;
use crate::source::SourceCloud;
use colours::{Codes, white_of};
use foveal_core::content::mesh::payload::Attributes;
use foveal_core::content::points::cloud::Cloud;
use foveal_core::content::points::payload::{CloudPoint, PointAttributes};
use foveal_core::content::scene::description::{Grid, ObjectBounds, SceneObject, Shape};
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::unit::UnitId;
use glam::{DAffine3, DVec3};
use octree::{CloudNode, Octree, OctreeError};
use rayon::prelude::*;
use signature::Light;

/// A cloud as units.
pub(super) struct BuiltCloud {
    pub(super) object: SceneObject,
    pub(super) units: Graphed,
    /// Points that were left out where too many lie at one place.
    pub(super) left_out: u64,
}

/// Most points of one place where some have more than a tree can distinguish: a few units of them.
const MOST_OF_PLACE: usize = 1 << 15;

/// Turns a cloud into units; `step` hears how many points are done.
pub(super) fn build(
    source: &SourceCloud,
    object: u16,
    step: &(dyn Fn(u64) + Sync),
) -> Result<BuiltCloud, BuildError> {
    check(source).map_err(|what| BuildError::Source {
        object: source.name.clone(),
        what,
    })?;
    let codes = Codes::of(&source.colours);
    let least = [0, 1, 2].map(|k| source.places.iter().map(|it| it[k]).min().unwrap_or(0));
    let mut points: Vec<CloudPoint> = (0..source.places.len())
        .into_par_iter()
        .map(|number| point(source, &codes, least, number))
        .collect();
    let has = |is: fn(&CloudPoint) -> bool| points.par_iter().any(is);
    let attributes = PointAttributes {
        colours: has(|it| it.colour != [0; 3]),
        intensities: has(|it| it.intensity != 0),
        classes: has(|it| it.class != 0),
    };
    let mut cloud = Cloud {
        count: 0,
        scale: source.scale,
        offset: source.offset,
        least: least.map(i64::from),
        attributes,
        colour_bits: codes.bits,
        colour_times: codes.times,
        most_intensity: white_of(points.iter().map(|it| it.intensity)),
    };
    let octree = Octree {
        attributes,
        light: Light::new(attributes, codes.bits, cloud.most_intensity),
        scale: source.scale,
        step,
    };
    let (nodes, left_out) = match octree.build(&mut points) {
        Err(OctreeError::Deep) => {
            let left_out = leave_out_repeats(&mut points);
            (octree.build(&mut points), left_out)
        }
        nodes => (nodes, 0),
    };
    let nodes = nodes.map_err(|error| match error {
        OctreeError::Deep => BuildError::Source {
            object: source.name.clone(),
            what: "more points at few places than can be distinguished",
        },
        OctreeError::Unit(error) => BuildError::Unit(error),
    })?;
    cloud.count = points.len() as u64;
    let bounds = bounds(&cloud, &points);
    drop(points);
    let object_of = object_of(source, cloud, bounds);
    Ok(BuiltCloud {
        object: object_of,
        units: numbered(nodes, object),
        left_out,
    })
}

/// Leaves out points beyond so many that follow each other at one place; returns how many.
fn leave_out_repeats(points: &mut Vec<CloudPoint>) -> u64 {
    let (before, mut place, mut met) = (points.len(), None, 0);
    points.retain(|point| {
        let is_same = place == Some(point.place);
        met = if is_same { met + 1 } else { 1 };
        place = Some(point.place);
        met <= MOST_OF_PLACE
    });
    (before - points.len()) as u64
}

fn check(source: &SourceCloud) -> Result<(), &'static str> {
    let count = source.places.len();
    let fits = |length: usize| length == 0 || length == count;
    let lengths = [
        source.colours.len(),
        source.intensities.len(),
        source.classes.len(),
    ];
    if count == 0 || u32::try_from(count).is_err() {
        return Err("no point, or more than 4 thousand million");
    }
    if !lengths.into_iter().all(fits) {
        return Err("not one colour, intensity and class a point");
    }
    if source.placements.is_empty() {
        return Err("no placement");
    }
    let is_step = |it: &f64| *it > 0.0 && *it <= 1e12;
    let is_near = source.reach().max_element() <= 1e15;
    match source.scale.iter().all(is_step) && is_near {
        true => Ok(()),
        false => Err("an invalid scale, or a position beyond 1e15"),
    }
}

/// A point on the grid whose first place is the cloud's least.
fn point(source: &SourceCloud, codes: &Codes, least: [i32; 3], number: usize) -> CloudPoint {
    let place = source.places[number];
    CloudPoint {
        place: [0, 1, 2].map(|k| place[k].wrapping_sub(least[k]) as u32),
        colour: source
            .colours
            .get(number)
            .map_or([0; 3], |it| codes.told(*it)),
        intensity: source.intensities.get(number).copied().unwrap_or(0),
        class: source.classes.get(number).copied().unwrap_or(0),
    }
}

/// The sphere round all points about the middle of their box.
fn bounds(cloud: &Cloud, points: &[CloudPoint]) -> ObjectBounds {
    let all = || points.iter().map(|it| cloud.at(it.place));
    let low = all().fold(DVec3::INFINITY, DVec3::min);
    let high = all().fold(DVec3::NEG_INFINITY, DVec3::max);
    let centre = (low + high) / 2.0;
    // A single point has the size of a step.
    let step = cloud.scale.into_iter().fold(0.0, f64::max);
    ObjectBounds {
        centre: centre.to_array(),
        radius: all().map(|it| it.distance(centre)).fold(step, f64::max),
        half: ((high - low) / 2.0).to_array(),
    }
}

fn object_of(source: &SourceCloud, cloud: Cloud, bounds: ObjectBounds) -> SceneObject {
    let origin = cloud.at([0; 3]);
    SceneObject {
        name: source.name.clone(),
        shape: Shape::Cloud(cloud),
        bounds,
        grid: Grid {
            origin: origin.to_array(),
            step: cloud.scale.into_iter().fold(0.0, f64::max),
            bits: 16,
        },
        attributes: Attributes::default(),
        colour: [1.0; 4],
        two_sided: true,
        unlit: true,
        placements: source
            .placements
            .iter()
            .map(DAffine3::to_cols_array)
            .collect(),
        texturing: None,
    }
}

/// The nodes as units in order, and the number of levels. Nodes come parents first, along a curve.
fn numbered(nodes: Vec<CloudNode>, object: u16) -> Graphed {
    let deepest = nodes.iter().map(|node| node.depth).max().unwrap_or(0);
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by_key(|node| nodes[*node].depth);
    let mut unit_of = vec![UnitId(0); nodes.len()];
    for (node, unit) in order.iter().zip(0..) {
        unit_of[*node] = UnitId(unit);
    }
    let mut nodes: Vec<Option<CloudNode>> = nodes.into_iter().map(Some).collect();
    let taken = order.iter().filter_map(|node| nodes[*node].take());
    let unit = |node: CloudNode| BuiltUnit {
        level: (deepest - node.depth) as u8,
        row: UnitRow {
            kind: UnitKind::Points,
            object,
            centre: node.sphere.centre,
            radius: node.sphere.radius,
            error: node.error,
            signature: node.signature,
            samples: node.count,
            vertices: 0,
            needs: node.parent.map(|it| unit_of[it]).into_iter().collect(),
            replaces: node
                .parent
                .map(|_| PartRef {
                    need: 0,
                    part: node.octant,
                })
                .into_iter()
                .collect(),
        },
        payload: node.payload,
    };
    Graphed {
        units: taken.map(unit).collect(),
        levels: deepest as u8 + 1,
    }
}
