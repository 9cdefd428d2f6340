//! What does a group of clusters look like with half the triangles?

mod folds;
mod scattered;

use super::clusters::{GraphCluster, Part, adapter};
use super::grid_mesh::{GridMesh, KnownVertices};
use crate::build::numbering::Numbering;
use folds::{Unfolded, unfold};
use foveal_core::content::mesh::octahedral::direction_from_octahedral;
use foveal_core::content::mesh::payload::MeshVertex;
use meshopt::SimplifyOptions;
use scattered::{has_lost_area, thin};
use std::borrow::Cow;

/// What part of the triangles is to stay.
const RATIO: f64 = 0.5;
/// A group that keeps more than this part of its triangles is stuck: as meshoptimizer's clusterlod
/// has it.
const STUCK: f64 = 0.85;
/// Weight of each coordinate of a normal against a move by the extent of a group: as in
/// meshoptimizer's demos.
const NORMAL_WEIGHT: f32 = 0.5;
/// Weight of each channel of a colour.
const COLOUR_WEIGHT: f32 = 0.5;
/// Weight of a slide of a texture along a surface against a move off it by as much.
const SLIDE_WEIGHT: f32 = 0.5;

/// A group with about half the triangles.
pub(in crate::build) struct Simplified {
    /// The coarse clusters.
    pub clusters: Vec<GraphCluster>,
    /// How far they are from the fine ones, in steps of the grid.
    pub error: f32,
    /// Whether attributes were let go of where they jump.
    pub permissive: bool,
    /// Vertices that the mesh lacks: clusters number them after those that it has.
    pub added: Vec<MeshVertex>,
}

/// Simplifies a group, given whether each vertex of the mesh stays; none where it is stuck.
pub(in crate::build) fn simplify(
    mesh: &GridMesh,
    fine: &[&GraphCluster],
    locked: &[bool],
) -> Option<Simplified> {
    let count = fine.iter().map(|it| it.vertices.len()).sum();
    let mut part = Part::new(mesh, fine.iter().flat_map(|it| it.corners()), count);
    let unfolded = unfold(mesh, &mut part);
    // Clusters that stand for others are about as large.
    let owed = fine
        .iter()
        .map(|it| f64::from(it.owed.max(1.0)))
        .sum::<f64>();
    let mut group = Group {
        owed: owed / fine.len().max(1) as f64,
        attributes: attributes(mesh, &part),
        locks: part
            .vertices
            .iter()
            .map(|it| locked[*it as usize])
            .collect(),
        unfolded,
        part,
    };
    let plain = SimplifyOptions::ErrorAbsolute | SimplifyOptions::ErrorClamped;
    let tries = [(plain, false), (plain | SimplifyOptions::Permissive, true)];
    // Only attributes can be let go of.
    let tries = &tries[..if group.attributes.weights.is_empty() {
        1
    } else {
        2
    }];
    let halved = tries.iter().find_map(|(options, permissive)| {
        let (corners, error) = group.halve(*options, *permissive)?;
        let same = |it: u32| group.unfolded.same[it as usize];
        let corners: Vec<u32> = corners.into_iter().map(same).collect();
        Some((corners, error, *permissive))
    });
    let is_whole = halved
        .as_ref()
        .is_some_and(|it| !has_lost_area(&group.part, &it.0));
    if let (false, Some(thinned)) = (is_whole, group.thinned(mesh)) {
        return Some(thinned);
    }
    let (corners, error, permissive) = halved?;
    Some(Simplified {
        clusters: group.part.clusters(&corners),
        error,
        permissive,
        added: Vec::new(),
    })
}

impl Simplified {
    /// Gives the mesh the added vertices, each value once; corners assumed the number `there` for
    /// the first. `known` has the vertices of the mesh once any was added.
    pub(in crate::build) fn take_into(
        &mut self,
        mesh: &mut GridMesh,
        there: u32,
        known: &mut Option<KnownVertices>,
    ) {
        if self.added.is_empty() {
            return;
        }
        let known = known.get_or_insert_with(|| KnownVertices::of(mesh));
        let numbers = self.added.iter().map(|it| known.number(mesh, *it));
        let numbers: Vec<u32> = numbers.collect();
        for cluster in &mut self.clusters {
            let mut vertices = Numbering::new(cluster.vertices.len());
            let number = |it: &u32| match it.checked_sub(there) {
                Some(added) => vertices.number(numbers[added as usize]) as u8,
                None => vertices.number(*it) as u8,
            };
            let places: Vec<u8> = cluster.vertices.iter().map(number).collect();
            for corner in cluster.triangles.as_flattened_mut() {
                *corner = places[usize::from(*corner)];
            }
            cluster.vertices = vertices.vertices;
        }
    }
}

struct Group {
    /// The area that it stands for, as a multiple of its own.
    owed: f64,
    part: Part,
    attributes: Weighed,
    locks: Vec<bool>,
    unfolded: Unfolded,
}

impl Group {
    /// The same for many small parts that lie apart.
    fn thinned(&mut self, mesh: &GridMesh) -> Option<Simplified> {
        let before = self.part.corners.len();
        let thinned = thin(mesh, &mut self.part, &self.locks, self.owed)?;
        let is_halved = thinned.corners.len() as f64 <= before as f64 * STUCK;
        let clusters = self.part.clusters(&thinned.corners).into_iter();
        is_halved.then(|| Simplified {
            clusters: clusters
                .map(|it| GraphCluster {
                    owed: thinned.owed as f32,
                    ..it
                })
                .collect(),
            error: thinned.error,
            permissive: false,
            added: thinned.added,
        })
    }

    fn halve(&self, options: SimplifyOptions, permissive: bool) -> Option<(Vec<u32>, f32)> {
        let triangles = self.part.corners.len() / 3;
        let target = (triangles as f64 * RATIO) as usize;
        let mut error = 0.0;
        let weighed = &self.attributes;
        // Where attributes may be let go of, seams may be.
        let folds = match permissive {
            true => &self.unfolded.rim,
            false => &self.unfolded.stuck,
        };
        let mut locks = Cow::Borrowed(&self.locks);
        if folds.contains(&true) {
            let all = locks.to_mut().iter_mut().zip(folds);
            all.for_each(|(lock, is_fold)| *lock |= is_fold);
        }
        let corners = meshopt::simplify_with_attributes_and_locks(
            &self.part.corners,
            &adapter(&self.part.positions),
            &weighed.values,
            &weighed.weights,
            size_of_val(&weighed.weights[..]),
            &locks,
            3 * target,
            f32::MAX,
            options,
            Some(&mut error),
        );
        let most = triangles as f64 * STUCK;
        let is_halved = !corners.is_empty() && (corners.len() / 3) as f64 <= most;
        is_halved.then_some((corners, error))
    }
}

/// What vertices have besides a place, with weights.
struct Weighed {
    values: Vec<f32>,
    weights: Vec<f32>,
}

/// The largest extent of places along an axis, at least 1.
fn extent(places: &[[f32; 3]]) -> f32 {
    let along = |axis: usize| {
        let along = places.iter().map(|place| place[axis]);
        along.clone().fold(0.0, f32::max) - along.fold(f32::INFINITY, f32::min)
    };
    [0, 1, 2].map(along).into_iter().fold(1.0, f32::max)
}

fn attributes(mesh: &GridMesh, part: &Part) -> Weighed {
    let has = mesh.object.attributes;
    let mut weights = Vec::new();
    if has.normals {
        weights.extend([NORMAL_WEIGHT; 3]);
    }
    if has.colours {
        weights.extend([COLOUR_WEIGHT; 4]);
    }
    if has.textured {
        // What a weight counts against is a move by the extent.
        weights.extend([SLIDE_WEIGHT / extent(&part.positions); 2]);
    }
    let mut values = Vec::with_capacity(weights.len() * part.vertices.len());
    for vertex in &part.vertices {
        let vertex = &mesh.vertices[*vertex as usize];
        if has.normals {
            values.extend(direction_from_octahedral(vertex.normal));
        }
        if has.colours {
            values.extend(vertex.colour.map(|it| f32::from(it) / 255.0));
        }
        if has.textured {
            let along = vertex.uv.iter().zip(mesh.places_of_uv);
            values.extend(along.map(|(it, places)| f32::from(*it) * places));
        }
    }
    Weighed { values, weights }
}
