//! Which points of a cloud does each unit add?

use super::super::sphere::LocalSphere;
use super::colours::Mix;
use super::signature::{Light, signature_of};
use super::stretches::{along_curve, cell_ends, common_depth};
use foveal_core::content::points::payload::{
    CloudPoint, Correction, MOST_POINTS, PointAttributes, PointUnit,
};
use foveal_core::pack::PackError;
use foveal_core::perception::measures::contrast::Signature;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Most levels below a cube at which cells are distinguished there: places are shown in 65536ths of
/// a side.
const MOST_CELLS: u32 = 12;
/// Most levels of a tree: those of a scene are at most 40.
const MOST_DEPTH: u32 = 38;

/// Points are looked at for how far they are apart in cells so many levels below a cube.
const LOOKED_AT: u32 = 3;
/// Where these depths differ by so much, sixteenfold in points by area, a cube is parted.
const UNEVEN: u32 = 2;
/// Fewer points are not parted for that.
const FEW_POINTS: usize = 512;
/// Nor are any at this depth.
const MOST_PARTED: u32 = 24;

/// A unit before it has a number.
pub(super) struct CloudNode {
    /// The node whose octant it refines; of the root none.
    pub(super) parent: Option<usize>,
    pub(super) octant: u8,
    pub(super) depth: u32,
    pub(super) sphere: LocalSphere,
    pub(super) error: f32,
    pub(super) signature: Signature,
    /// Number of points that it adds.
    pub(super) count: u32,
    pub(super) payload: Vec<u8>,
}

/// Why there is no tree.
#[derive(Debug)]
pub(super) enum OctreeError {
    /// Too many points at one place.
    Deep,
    Unit(PackError),
}

impl From<PackError> for OctreeError {
    fn from(error: PackError) -> Self {
        Self::Unit(error)
    }
}

/// How a tree is made.
pub(super) struct Octree<'a> {
    pub(super) attributes: PointAttributes,
    pub(super) light: Light,
    /// Length of a step along each axis.
    pub(super) scale: [f64; 3],
    /// Hears how many points are done.
    pub(super) step: &'a (dyn Fn(u64) + Sync),
}

/// A stretch of points along the curve: those in a cube.
struct Part<'a> {
    points: &'a [CloudPoint],
    /// Those that coarser nodes added.
    taken: &'a mut [bool],
    depth: u32,
    octant: u8,
    corner: [u32; 3],
    /// The depth at whose cells coarser nodes added a point each; of the root none.
    cells: Option<u32>,
    /// What is missing to the colours of the points that the parent added here.
    corrections: Vec<Correction>,
}

/// What a node adds.
struct Added {
    points: Vec<CloudPoint>,
    /// What is missing to the own colour of each, by place; of the others nothing.
    missing: HashMap<[u32; 3], Correction>,
    /// The depth at whose cells points are from now on.
    cells: u32,
    /// Whether none are left.
    is_leaf: bool,
}

impl Octree<'_> {
    /// The nodes of a tree of these points, which are put in order: parents first, along a curve.
    pub(super) fn build(&self, points: &mut [CloudPoint]) -> Result<Vec<CloudNode>, OctreeError> {
        points.par_sort_unstable_by(along_curve);
        let most = points.par_iter().map(|it| it.place.map(u32::leading_zeros));
        let zeros = most.map(|it| it[0].min(it[1]).min(it[2])).min();
        let bits = u32::BITS - zeros.unwrap_or(u32::BITS);
        let mut taken = vec![false; points.len()];
        let root = Part {
            points,
            taken: &mut taken,
            depth: 0,
            octant: 0,
            corner: [0; 3],
            cells: None,
            corrections: Vec::new(),
        };
        self.node(root, bits)
    }

    /// A node and all below it, whose cube is one of `bits` at depth 0.
    fn node(&self, mut part: Part<'_>, bits: u32) -> Result<Vec<CloudNode>, OctreeError> {
        if part.depth > MOST_DEPTH {
            return Err(OctreeError::Deep);
        }
        let added = added(&mut part, bits);
        let depth = part.depth;
        let mut unit = PointUnit {
            corner: part.corner,
            bits: bits.saturating_sub(depth) as u8,
            cells: added.cells.saturating_sub(depth) as u8,
            points: added.points,
            corrections: part.corrections,
        };
        let payload = unit.write(self.attributes)?;
        (self.step)(unit.points.len() as u64);
        let corrections = corrections_of(&unit, &added.missing);
        let signature = part.cells.map(|coarse| {
            let fine = if added.is_leaf { bits } else { added.cells };
            signature_of(part.points, [coarse, fine], bits, &self.light)
        });
        let signature = signature.unwrap_or_default();
        let mut nodes = vec![CloudNode {
            parent: None,
            octant: part.octant,
            depth,
            sphere: self.sphere(part.points),
            error: part
                .cells
                .map_or(f32::INFINITY, |cells| self.spacing(bits, cells)),
            signature,
            count: unit.points.len() as u32,
            payload,
        }];
        drop((unit.points, added.missing));
        let parts = octants(part.points, part.taken, (depth, bits));
        let children = parts
            .into_par_iter()
            .zip(corrections)
            .map(|(octant, corrections)| {
                let (points, taken, number) = octant;
                if taken.iter().all(|taken| *taken) {
                    return Ok(Vec::new());
                }
                let half = 1_u64 << bits.saturating_sub(depth + 1);
                let farther = |k: usize| u64::from(number >> k & 1) * half;
                let corner = [0, 1, 2].map(|k| part.corner[k] + farther(k) as u32);
                let below = Part {
                    points,
                    taken,
                    depth: depth + 1,
                    octant: number,
                    corner: if bits > depth { corner } else { part.corner },
                    cells: Some(added.cells),
                    corrections,
                };
                self.node(below, bits)
            });
        for below in children.collect::<Result<Vec<_>, _>>()? {
            add_below(&mut nodes, below);
        }
        Ok(nodes)
    }

    /// How far points are apart that lie in cells of a depth.
    fn spacing(&self, bits: u32, cells: u32) -> f32 {
        let step = self.scale.into_iter().fold(0.0, f64::max);
        let steps = (1_u64 << bits.saturating_sub(cells)) as f64;
        (step * steps) as f32
    }

    /// A sphere round points, from the first place of the grid.
    fn sphere(&self, points: &[CloudPoint]) -> LocalSphere {
        let none = ([u32::MAX; 3], [0; 3]);
        let (least, most) = points.iter().fold(none, |(least, most), it| {
            let least = [0, 1, 2].map(|k| it.place[k].min(least[k]));
            (least, [0, 1, 2].map(|k| it.place[k].max(most[k])))
        });
        let scale = DVec3::from_array(self.scale);
        let [least, most] = [least, most].map(|it| DVec3::from_array(it.map(f64::from)) * scale);
        let centre = ((least + most) / 2.0).as_vec3();
        let away = (most - centre.as_dvec3())
            .abs()
            .max((least - centre.as_dvec3()).abs());
        LocalSphere {
            centre: centre.to_array(),
            radius: (away.length() as f32).next_up(),
        }
    }
}

/// Adds the nodes of an octant of the first.
fn add_below(nodes: &mut Vec<CloudNode>, mut below: Vec<CloudNode>) {
    let first = nodes.len();
    for node in &mut below {
        node.parent = Some(node.parent.map_or(0, |parent| parent + first));
    }
    if let Some(child) = below.first() {
        nodes[0].sphere = round(nodes[0].sphere, &child.sphere);
    }
    nodes.append(&mut below);
}

/// A sphere with the centre of one, round both.
fn round(outer: LocalSphere, inner: &LocalSphere) -> LocalSphere {
    let reach = inner.reach(outer.centre);
    match reach <= f64::from(outer.radius) {
        true => outer,
        false => LocalSphere {
            radius: (reach as f32).next_up(),
            ..outer
        },
    }
}

/// The octants of a part that have points: these, and the octant's number.
fn octants<'a>(
    points: &'a [CloudPoint],
    taken: &'a mut [bool],
    (depth, bits): (u32, u32),
) -> [(&'a [CloudPoint], &'a mut [bool], u8); 8] {
    let (mut points, mut taken) = (points, taken);
    [0, 1, 2, 3, 4, 5, 6, 7].map(|number| {
        let bit = bits.checked_sub(depth + 1);
        let octant = |point: &CloudPoint| {
            let far = |k: usize| bit.map_or(0, |bit| (point.place[k] >> bit & 1) as u8);
            far(0) | far(1) << 1 | far(2) << 2
        };
        let end = points.partition_point(|point| octant(point) <= number);
        let (these, rest) = points.split_at(end);
        let (taken_here, taken_rest) = std::mem::take(&mut taken).split_at_mut(end);
        (points, taken) = (rest, taken_rest);
        (these, taken_here, number)
    })
}

/// What is missing to the colours of a unit's points, by octant, in the order of the unit.
fn corrections_of(
    unit: &PointUnit,
    missing: &HashMap<[u32; 3], Correction>,
) -> [Vec<Correction>; 8] {
    let mut all: [Vec<Correction>; 8] = Default::default();
    for point in &unit.points {
        let octant = usize::from(unit.octant_of_place(point.place));
        all[octant].push(missing.get(&point.place).copied().unwrap_or_default());
    }
    all
}

/// Which points a node adds, and marks them.
fn added(part: &mut Part<'_>, bits: u32) -> Added {
    let left = part.taken.iter().filter(|taken| !**taken).count();
    let before = part.cells.unwrap_or(part.depth);
    let deepest = bits.min(part.depth + MOST_CELLS);
    let occupied = occupied_cells(part.points, bits);
    let first = part.cells.map_or(part.depth, |cells| cells + 1);
    if left <= MOST_POINTS {
        let [sparse, usual, dense] = filled_depths(part, bits);
        let is_even = dense < sparse + UNEVEN || left < FEW_POINTS;
        if is_even || sparse < first || sparse >= deepest || part.depth >= MOST_PARTED {
            return Added {
                is_leaf: true,
                ..first_left(part, usual.clamp(before, deepest.max(before)))
            };
        }
        // Where points lie close together, octants have the others, at spacings of their own.
        return spread(part, sparse, bits, |_| true);
    }
    if bits <= part.depth || first > deepest {
        return first_left(part, before);
    }
    let fitting = |cells: &u32| occupied[*cells as usize] as usize <= MOST_POINTS;
    let surely = (first..=deepest).rev().find(fitting).unwrap_or(first);
    let fits = |cells: &u32| free_cells(part, *cells, bits) <= MOST_POINTS;
    match (surely..=deepest).take_while(fits).last() {
        Some(cells) => spread(part, cells, bits, |_| true),
        None => {
            // Much in a small part of the cube: some of it, evenly along the curve.
            let all = free_cells(part, first, bits);
            let chosen = |number: usize| number * MOST_POINTS / all;
            let some = |number| chosen(number + 1) > chosen(number);
            Added {
                cells: before,
                ..spread(part, first, bits, some)
            }
        }
    }
}

/// The depths down to whose cells points fill a cube without many holes: of the twelfth of it, by
/// area, where they are farthest apart, of a quarter, and of all but a twelfth.
fn filled_depths(part: &Part<'_>, bits: u32) -> [u32; 3] {
    let looked_at = bits.min(part.depth + LOOKED_AT);
    let mut depths = Vec::new();
    let mut start = 0;
    for end in cell_ends(part.points, looked_at, bits) {
        let cell = &part.points[std::mem::replace(&mut start, end)..end];
        let occupied = occupied_cells(cell, bits);
        // Points that lie anywhere leave few holes then.
        let third = cell.len() as u32 / 3;
        let depth = (looked_at..bits).find(|cells| occupied[*cells as usize] >= third);
        depths.push(depth.unwrap_or(bits));
    }
    depths.sort_unstable();
    [1, 3, 11].map(|of_twelve| {
        depths
            .get(depths.len() * of_twelve / 12)
            .copied()
            .unwrap_or(0)
    })
}

/// For each depth how many cells have points.
fn occupied_cells(points: &[CloudPoint], bits: u32) -> Vec<u32> {
    let mut cells = vec![0; bits as usize + 2];
    for pair in points.windows(2) {
        cells[common_depth(&pair[0], &pair[1], bits) as usize + 1] += 1;
    }
    let mut sum = 1;
    for count in &mut cells {
        sum += *count;
        *count = sum;
    }
    cells
}

/// How many cells of a depth have points, none of which a coarser node added.
fn free_cells(part: &Part<'_>, depth: u32, bits: u32) -> usize {
    let mut start = 0;
    let is_free = |end: &usize| {
        let cell = std::mem::replace(&mut start, *end)..*end;
        !part.taken[cell].contains(&true)
    };
    cell_ends(part.points, depth, bits).filter(is_free).count()
}

/// Adds the first that are left, in their own colours.
fn first_left(part: &mut Part<'_>, cells: u32) -> Added {
    let mut points = Vec::new();
    for (point, taken) in part.points.iter().zip(&mut *part.taken) {
        if !*taken && points.len() < MOST_POINTS {
            *taken = true;
            points.push(*point);
        }
    }
    Added {
        points,
        missing: HashMap::new(),
        cells,
        is_leaf: false,
    }
}

/// Adds, of each free cell of a depth whose number is chosen, the point nearest to its middle, in
/// the mean colour of all points of the cell.
fn spread(part: &mut Part<'_>, depth: u32, bits: u32, is_chosen: impl Fn(usize) -> bool) -> Added {
    let (mut points, mut missing) = (Vec::new(), HashMap::new());
    let (mut start, mut number) = (0, 0);
    for end in cell_ends(part.points, depth, bits) {
        let cell = std::mem::replace(&mut start, end)..end;
        if part.taken[cell.clone()].contains(&true) {
            continue;
        }
        number += 1;
        if !is_chosen(number - 1) {
            continue;
        }
        let all = &part.points[cell.clone()];
        let middle = nearest_to_middle(all, bits - depth);
        let mut mix = Mix::default();
        all.iter().for_each(|it| mix.add(it.colour));
        let (own, mean) = (all[middle], mix.mean());
        if own.colour != mean {
            let missing_of = [0, 1, 2].map(|k| i32::from(own.colour[k]) - i32::from(mean[k]));
            missing.insert(own.place, missing_of);
        }
        part.taken[cell.start + middle] = true;
        points.push(CloudPoint {
            colour: mean,
            ..own
        });
    }
    Added {
        points,
        missing,
        cells: depth,
        is_leaf: false,
    }
}

/// The number of the point of a cell that is nearest to its middle; a side has `side_bits`.
fn nearest_to_middle(cell: &[CloudPoint], side_bits: u32) -> usize {
    let away = |point: &CloudPoint| {
        let along = point.place.map(|it| {
            // Twice the distance, so that the middle is a whole number.
            let inside = u64::from(it) & ((1 << side_bits) - 1);
            (2 * inside + 1).abs_diff(1 << side_bits)
        });
        along.iter().map(|it| u128::from(*it).pow(2)).sum::<u128>()
    };
    let nearest = (0..cell.len()).min_by_key(|number| away(&cell[*number]));
    nearest.unwrap_or(0)
}
