//! Which triangles fill a face of more than three corners?
//!
//! A fan where it fits the outline, as it does for all convex ones; else those that the crate
//! `earcut` cuts, which adds no vertices.

use std::collections::HashSet;

use earcut::Earcut;
use glam::{DVec2, DVec3};

use super::mends::{CROSSING, Mends, NOT_FILLED};
use crate::source::SourceMesh;

/// Most corners of an outline that crosses itself: cutting it may take the cube of their number.
const MOST_CROSSING: usize = 256;
/// Most that is spent on the concave outlines of a mesh: the squares of their numbers of corners,
/// summed. That is some ten seconds, for combs with long teeth.
const MOST_SPENT: u64 = 1 << 33;
/// An outline is a fan if no triangle of it turns back by more than this part of the area.
const TOLERANCE: f64 = 1e-9;
/// Triangles that cover so much more or less than their outline show that it crosses itself.
const AREA_TOLERANCE: f64 = 1e-4;

/// How an outline was filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filling {
    /// By a fan from its first corner.
    Fan,
    /// By other triangles.
    Cut,
    /// By triangles that cover what they can: it crosses itself.
    Crossing,
    /// By a fan that may cover more than the face: it has too many corners.
    TooLarge,
}

/// Fills outlines.
#[derive(Default)]
pub(super) struct Filler {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    cut: Vec<u32>,
    spent: u64,
}

impl Filler {
    /// Finds the triangles that fill an outline, by numbers of its corners, of which there are at
    /// least three, all finite; none where a fan from its first corner is as good. The outline may
    /// be nearly flat, and may have holes that edges walked to and fro join to it. Its winding is
    /// kept.
    pub(super) fn fill(&mut self, outline: &[DVec3]) -> (Filling, Vec<[u32; 3]>) {
        let fan = self.flatten(outline);
        if let Some(filling) = fan {
            return (filling, Vec::new());
        }
        let corners = outline.len() as u64;
        if self.spent + corners * corners > MOST_SPENT {
            return (Filling::TooLarge, Vec::new());
        }
        self.spent += corners * corners;
        let crosses = crosses(&self.flat);
        if crosses && outline.len() > MOST_CROSSING {
            return (Filling::Crossing, Vec::new());
        }
        self.earcut.earcut_slice(&self.flat, &[], &mut self.cut);
        let mut triangles: Vec<[u32; 3]> = self.cut.as_chunks().0.to_vec();
        // The outline is flattened so that its area is positive; the crate may wind the other way.
        let areas: f64 = triangles.iter().map(|it| self.area(*it)).sum();
        if areas < 0.0 {
            triangles.iter_mut().for_each(|it| it.swap(1, 2));
        }
        let covered: f64 = triangles.iter().map(|it| self.area(*it).abs()).sum();
        let area = area_of(&self.flat);
        join(&self.flat, &mut triangles);
        let fits = (covered - area).abs() <= AREA_TOLERANCE * area;
        match crosses || !fits {
            true => (Filling::Crossing, triangles),
            false => (Filling::Cut, triangles),
        }
    }

    fn area(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|it| DVec2::from_array(self.flat[it as usize]));
        (b - a).perp_dot(c - a) / 2.0
    }

    /// Lays an outline flat, its first corner at 0, unless a fan from there fills it.
    fn flatten(&mut self, outline: &[DVec3]) -> Option<Filling> {
        let first = outline[0];
        let edges = outline.windows(2).skip(1);
        let doubled = edges.map(|edge| (edge[0] - first).cross(edge[1] - first));
        let normal: DVec3 = doubled.clone().sum();
        let doubled_area = normal.length();
        let covered: f64 = doubled.clone().map(DVec3::length).sum();
        let Some(up) = normal.try_normalize() else {
            let is_line = covered == 0.0 || !covered.is_finite();
            return Some(if is_line {
                Filling::Fan
            } else {
                Filling::Crossing
            });
        };
        if doubled_area <= TOLERANCE * covered {
            return Some(Filling::Crossing);
        }
        let mut turned = doubled.map(|it| it.dot(up));
        if turned.all(|area| area >= -TOLERANCE * doubled_area) {
            return Some(Filling::Fan);
        }
        // Seen along the axis that the face looks along most: nothing is rounded.
        let size = up.abs();
        let (along, sign) = match size.max_element() {
            most if most == size.z => ([0, 1], up.z),
            most if most == size.y => ([2, 0], up.y),
            _ => ([1, 2], up.x),
        };
        let along = if sign < 0.0 {
            [along[1], along[0]]
        } else {
            along
        };
        self.flat.clear();
        self.flat.extend(outline.iter().map(|corner| {
            let corner = *corner - first;
            along.map(|axis| corner[axis])
        }));
        None
    }
}

fn area_of(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let pairs = outline.iter().zip(next);
    pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
}

/// Whether two edges of an outline cross, each away from the ends of the other.
fn crosses(outline: &[[f64; 2]]) -> bool {
    let corner = |at: usize| DVec2::from_array(outline[at % outline.len()]);
    let edges = (0..outline.len()).map(|at| (corner(at), corner(at + 1)));
    let mut edges: Vec<(DVec2, DVec2)> = edges
        .map(|(a, b)| if a.x <= b.x { (a, b) } else { (b, a) })
        .collect();
    edges.sort_by(|one, other| one.0.x.total_cmp(&other.0.x));
    let side = |(a, b): (DVec2, DVec2), c: DVec2| (b - a).perp_dot(c - a);
    let mut open: Vec<(DVec2, DVec2)> = Vec::new();
    for edge in edges {
        open.retain(|before| before.1.x > edge.0.x);
        let [low, high] = [edge.0.y.min(edge.1.y), edge.0.y.max(edge.1.y)];
        for before in &open {
            if before.0.y.max(before.1.y) < low || before.0.y.min(before.1.y) > high {
                continue;
            }
            let parts = |line, (a, b)| side(line, a) * side(line, b) < 0.0;
            if parts(*before, edge) && parts(edge, *before) {
                return true;
            }
        }
        open.push(edge);
    }
    false
}

/// Puts back corners that lie on a straight edge and that were left out there: else the mesh would
/// open up between this face and the next, which has them.
fn join(outline: &[[f64; 2]], triangles: &mut Vec<[u32; 3]>) {
    let bits = |at: u32| outline[at as usize].map(|it| (it + 0.0).to_bits());
    let edge = |[a, b]: [u32; 2]| (bits(a), bits(b));
    let sides = |it: &[u32; 3]| [[it[0], it[1]], [it[1], it[2]], [it[2], it[0]]];
    let count = outline.len() as u32;
    let walked: Vec<[u32; 2]> = (0..count).map(|at| [at, (at + 1) % count]).collect();
    let all = || triangles.iter().flat_map(sides);
    let covered: HashSet<_> = all().map(edge).collect();
    // Edges whose other side is another triangle's, or outside.
    let mut closed: HashSet<_> = walked.iter().map(|[a, b]| edge([*b, *a])).collect();
    closed.extend(&covered);
    let open = all().filter(|[a, b]| !closed.contains(&edge([*b, *a])));
    let mut ends: Vec<u32> = open.flatten().collect();
    if ends.is_empty() {
        return;
    }
    let bare = walked.iter().filter(|it| !covered.contains(&edge(**it)));
    ends.extend(bare.flatten());
    ends.sort_unstable();
    ends.dedup();
    let mut next = 0;
    while next < triangles.len() {
        let triangle = triangles[next];
        let split = (0..3).find_map(|turn| {
            let [a, b, c] = [0, 1, 2].map(|k| triangle[(turn + k) % 3]);
            let is_open = !closed.contains(&edge([b, a]));
            let between = is_open.then(|| nearest_between(outline, [a, b], &ends))??;
            Some([a, between, b, c])
        });
        let Some([a, between, b, c]) = split else {
            next += 1;
            continue;
        };
        // The first part ends at the nearest corner, so that only the second may have more.
        triangles[next] = [between, b, c];
        triangles.push([a, between, c]);
        closed.extend([[between, c], [c, between], [between, a]].map(edge));
    }
}

/// Of some corners the one that lies between two others, on the line through them, and is nearest
/// to the first.
fn nearest_between(outline: &[[f64; 2]], [a, b]: [u32; 2], corners: &[u32]) -> Option<u32> {
    let at = |corner: u32| DVec2::from_array(outline[corner as usize]);
    let (from, along) = (at(a), at(b) - at(a));
    let length = along.length_squared();
    let place = |corner: &u32| {
        let off = at(*corner) - from;
        let part = off.dot(along) / length;
        let is_on = along.perp_dot(off).abs() <= TOLERANCE * length;
        let is_inside = at(*corner) != at(a) && at(*corner) != at(b) && part > 0.0 && part < 1.0;
        (is_on && is_inside).then_some((part, *corner))
    };
    let found = corners.iter().filter_map(place);
    let nearest = found.min_by(|one, other| one.0.total_cmp(&other.0));
    nearest.map(|(_, corner)| corner)
}

/// Faces of more than three corners of a mesh, whose triangles are fans as yet.
#[derive(Debug, Default)]
pub(super) struct Polygons {
    /// The first triangle of each, and their number.
    fans: Vec<[usize; 2]>,
}

impl Polygons {
    /// Adds the fan of a face to triangles.
    pub(super) fn add(&mut self, triangles: &mut Vec<[u32; 3]>, corners: &[u32]) {
        let [first, rest @ ..] = corners else { return };
        let begin = triangles.len();
        let fan = rest.windows(2).map(|edge| [*first, edge[0], edge[1]]);
        triangles.extend(fan);
        if corners.len() > 3 {
            self.fans.push([begin, corners.len() - 2]);
        }
    }

    /// Replaces the fans that do not fill their outline. A face with a corner that is not there, or
    /// at no place, has it in all its triangles then, so that it is left out as a whole.
    pub(super) fn fill(self, mesh: &mut SourceMesh, mends: &mut Mends) {
        let mut filler = Filler::default();
        let mut others: Vec<([usize; 2], Vec<[u32; 3]>)> = Vec::new();
        let (mut corners, mut outline) = (Vec::new(), Vec::new());
        for [begin, length] in self.fans {
            let fan = &mut mesh.triangles[begin..begin + length];
            corners.clear();
            corners.extend(corners_of(fan));
            let place = |corner: &u32| mesh.positions.get(*corner as usize).copied();
            let is_there = |corner: &&u32| place(corner).is_some_and(DVec3::is_finite);
            if let Some(lost) = corners.iter().find(|it| !is_there(it)) {
                fan.iter_mut().for_each(|it| it[0] = *lost);
                continue;
            }
            outline.clear();
            outline.extend(corners.iter().filter_map(place));
            let (filling, triangles) = filler.fill(&outline);
            tell(filling, mends, || format!("at {:.6}", outline[0]));
            let named = triangles.iter().map(|it| it.map(|at| corners[at as usize]));
            match triangles.len() {
                0 => {}
                same if same == length => {
                    fan.iter_mut().zip(named).for_each(|(it, new)| *it = new);
                }
                _ => others.push(([begin, length], named.collect())),
            }
        }
        replace(mesh, &others);
    }
}

/// Counts what a filling could not do.
pub(super) fn tell(filling: Filling, mends: &mut Mends, place: impl FnOnce() -> String) {
    match filling {
        Filling::Fan | Filling::Cut => {}
        Filling::Crossing => mends.add(CROSSING, 1, place),
        Filling::TooLarge => mends.add(NOT_FILLED, 1, place),
    }
}

/// The corners of a fan, in order.
fn corners_of(fan: &[[u32; 3]]) -> impl Iterator<Item = u32> {
    let first = fan.first().map(|it| [it[0], it[1]]);
    first
        .into_iter()
        .flatten()
        .chain(fan.iter().map(|it| it[2]))
}

/// Puts other numbers of triangles in place of stretches of a mesh, which come in order.
fn replace(mesh: &mut SourceMesh, others: &[([usize; 2], Vec<[u32; 3]>)]) {
    if others.is_empty() {
        return;
    }
    let (triangles, materials) = (&mesh.triangles, &mesh.materials);
    let (mut all, mut of_all) = (Vec::with_capacity(triangles.len()), Vec::new());
    let mut at = 0;
    for ([begin, length], new) in others {
        all.extend_from_slice(&triangles[at..*begin]);
        all.extend_from_slice(new);
        if let Some(material) = materials.get(*begin) {
            of_all.extend_from_slice(&materials[at..*begin]);
            of_all.extend(std::iter::repeat_n(*material, new.len()));
        }
        at = begin + length;
    }
    all.extend_from_slice(&triangles[at..]);
    of_all.extend_from_slice(materials.get(at..).unwrap_or_default());
    (mesh.triangles, mesh.materials) = (all, of_all);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn area(outline: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let of = |it: &[u32; 3]| {
            let [a, b, c] = it.map(|at| outline[at as usize]);
            (b - a).cross(c - a).length() / 2.0
        };
        triangles.iter().map(of).sum()
    }

    /// A star in the plane of x and y, of area 4.70.
    fn star() -> Vec<DVec3> {
        let corner = |k: usize| {
            let angle = TAU / 4.0 + TAU / 10.0 * k as f64;
            let r = [2.0, 0.8][k % 2];
            DVec3::new(r * angle.cos(), r * angle.sin(), 0.0)
        };
        (0..10).map(corner).collect()
    }

    #[test]
    fn a_star_is_filled_from_each_side_and_from_each_corner() {
        let tilt = |it: DVec3| DVec3::new(it.y, 1e6 + it.x + it.y, it.x);
        for turn in 0..10 {
            let mut outline = star();
            outline.rotate_left(turn);
            let reversed: Vec<DVec3> = outline.iter().rev().copied().collect();
            let tilted: Vec<DVec3> = outline.iter().copied().map(tilt).collect();
            for outline in [&outline, &reversed, &tilted] {
                let (filling, mut triangles) = Filler::default().fill(outline);
                if filling == Filling::Fan {
                    // An inner corner sees all others.
                    triangles = (2..10).map(|at| [0, at - 1, at]).collect();
                }
                let normal = |it: &[u32; 3]| {
                    let [a, b, c] = it.map(|at| outline[at as usize]);
                    (b - a).cross(c - a)
                };
                let all: DVec3 = triangles.iter().map(normal).sum();
                assert_eq!(triangles.len(), 8, "{turn} {filling:?}");
                assert!(
                    triangles.iter().all(|it| normal(it).dot(all) > 0.0),
                    "{turn}"
                );
                assert!((area(outline, &triangles) * 2.0 - all.length()).abs() < 1e-3);
            }
        }
        assert_eq!(Filler::default().fill(&star()).0, Filling::Cut);
    }

    #[test]
    fn corners_on_straight_edges_stay_in_the_mesh() {
        // An L whose every edge has three corners more.
        let corners = [[0, 0], [8, 0], [8, 4], [4, 4], [4, 8], [0, 8]];
        let mut outline = Vec::new();
        for (at, [x, y]) in corners.iter().enumerate() {
            let [to_x, to_y] = corners[(at + 1) % 6];
            for part in 0..4 {
                let along = |from: i32, to: i32| f64::from(from * (4 - part) + to * part) / 4.0;
                outline.push(DVec3::new(along(*x, to_x), along(*y, to_y), 3.0));
            }
        }
        for turn in 0..outline.len() {
            outline.rotate_left(turn);
            let (filling, triangles) = Filler::default().fill(&outline);
            if filling == Filling::Cut {
                assert!((area(&outline, &triangles) - 48.0).abs() < 1e-9);
                let used: HashSet<u32> = triangles.iter().flatten().copied().collect();
                assert_eq!(used.len(), outline.len());
                assert_eq!(triangles.len(), outline.len() - 2);
            }
        }
    }

    #[test]
    fn a_hole_behind_a_bridge_stays_open() {
        let outline = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ];
        let outline = outline.map(|[x, y]| DVec3::new(x, y, 0.1 * x * y));
        let (filling, triangles) = Filler::default().fill(&outline);
        assert_eq!(filling, Filling::Cut);
        let flat = outline.map(|it| it.with_z(0.0));
        assert!(
            (area(&flat, &triangles) - 12.0).abs() < 1e-9,
            "{triangles:?}"
        );
    }

    #[test]
    fn what_crosses_itself_is_told_and_takes_no_time_without_end() {
        let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]];
        let mut bow = bow.map(|[x, y]| DVec3::new(x, y, 0.0));
        assert_eq!(Filler::default().fill(&bow).0, Filling::Crossing);
        bow[3].y = 2.0;
        assert_eq!(Filler::default().fill(&bow).0, Filling::Crossing);
        let many = 20_001;
        let corner = |k: usize| {
            let angle = TAU * (k * (many / 3) % many) as f64 / many as f64;
            DVec3::new(angle.cos(), angle.sin(), 0.0)
        };
        let many: Vec<DVec3> = (0..many).map(corner).collect();
        assert_ne!(Filler::default().fill(&many).0, Filling::Cut);
    }
}
