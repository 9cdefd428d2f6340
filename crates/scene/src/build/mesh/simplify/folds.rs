//! Where does a surface fold back onto itself?
//!
//! A sheet whose faces are there again, reversed, is a closed body without inside: each edge of its
//! rim has two triangles, and moving the rim inwards keeps all planes. So its error would be none,
//! and coarse levels would tear it. Where front and back are parted along such folds, the rim is a
//! seam instead, which moves along itself alone, both sides together.

use crate::build::mesh::clusters::Part;
use crate::build::mesh::grid_mesh::GridMesh;
use glam::DVec3;
use std::collections::HashMap;

/// Two triangles fold back if their angle has at least this cosine: 14 degrees.
const FOLDED: f64 = 0.97;

/// A part whose folds are seams.
pub(in crate::build) struct Unfolded {
    /// For each vertex of the part the one that it stood for before.
    pub same: Vec<u32>,
    /// The vertices on folds; empty where there are none.
    pub rim: Vec<bool>,
    /// Those of them that could not be parted.
    pub stuck: Vec<bool>,
}

/// Parts front and back along the folds of a part, which gets vertices more.
pub(in crate::build) fn unfold(mesh: &GridMesh, part: &mut Part) -> Unfolded {
    let mut same: Vec<u32> = (0..part.vertices.len() as u32).collect();
    let place = |vertex: u32| mesh.same_place[part.vertices[vertex as usize] as usize];
    let places: Vec<u32> = same.iter().map(|it| place(*it)).collect();
    let mut sides: HashMap<u32, Sides> = folds(part, &places);
    if sides.is_empty() {
        let none = Vec::new;
        return Unfolded {
            same,
            rim: none(),
            stuck: none(),
        };
    }
    let triangles = part.corners.as_chunks::<3>().0;
    // On which sides each vertex is: 1 for the front, 2 for the back.
    let mut on = vec![0_u8; places.len()];
    let mut back: Vec<[bool; 3]> = Vec::with_capacity(triangles.len());
    for triangle in triangles {
        let normal = normal_of(part, triangle);
        back.push(triangle.map(|corner| {
            let Some(at) = sides.get_mut(&places[corner as usize]) else {
                return false;
            };
            let is_back = at.is_back(normal);
            on[corner as usize] |= if is_back { 2 } else { 1 };
            is_back
        }));
    }
    let mut other: HashMap<u32, u32> = HashMap::new();
    for (corner, is_back) in part.corners.iter_mut().zip(back.as_flattened()) {
        if *is_back && on[*corner as usize] == 3 {
            let next = same.len() as u32;
            let number = *other.entry(*corner).or_insert(next);
            if number == next {
                same.push(*corner);
                part.vertices.push(part.vertices[*corner as usize]);
                part.positions.push(part.positions[*corner as usize]);
            }
            *corner = number;
        }
    }
    let at = |vertex: &u32| sides.get(&places[*vertex as usize]);
    Unfolded {
        rim: same.iter().map(|it| at(it).is_some()).collect(),
        stuck: same
            .iter()
            .map(|it| at(it).is_some_and(|it| !it.has_both))
            .collect(),
        same,
    }
}

/// The triangles round a place on a fold.
struct Sides {
    /// Where the first of them looks.
    front: DVec3,
    has_both: bool,
}

impl Sides {
    /// Whether a triangle that looks there is of the back.
    fn is_back(&mut self, normal: DVec3) -> bool {
        if self.front == DVec3::ZERO {
            self.front = normal;
        }
        let is_back = self.front.dot(normal) < 0.0;
        self.has_both |= is_back;
        is_back
    }
}

fn normal_of(part: &Part, triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|it| position(part, it));
    (b - a).cross(c - a)
}

fn position(part: &Part, vertex: u32) -> DVec3 {
    DVec3::from_array(part.positions[vertex as usize].map(f64::from))
}

/// The places on edges whose only two triangles lie on each other.
fn folds(part: &Part, places: &[u32]) -> HashMap<u32, Sides> {
    let triangles = part.corners.as_chunks::<3>().0;
    // Each edge by its places, with the triangle and the corner opposite.
    let mut edges: Vec<(u64, u32, u8)> = Vec::with_capacity(part.corners.len());
    for (triangle, number) in triangles.iter().zip(0..) {
        for (opposite, [a, b]) in [[1, 2], [2, 0], [0, 1]].into_iter().enumerate() {
            let [a, b] = [a, b].map(|it: usize| u64::from(places[triangle[it] as usize]));
            edges.push((a.min(b) << 32 | a.max(b), number, opposite as u8));
        }
    }
    edges.sort_unstable();
    let mut folds = HashMap::new();
    for same in edges.chunk_by(|one, other| one.0 == other.0) {
        let [one, other] = same else { continue };
        // How each triangle leads away from the edge.
        let away = |(_, triangle, opposite): &(u64, u32, u8)| {
            let triangle = &triangles[*triangle as usize];
            let at = |k: u8| position(part, triangle[usize::from((opposite + k) % 3)]);
            let along = (at(2) - at(1)).normalize_or_zero();
            let across = at(0) - at(1);
            across - along * across.dot(along)
        };
        let [one_away, other_away] = [away(one), away(other)];
        let lengths = one_away.length() * other_away.length();
        if lengths > 0.0 && one_away.dot(other_away) >= FOLDED * lengths {
            for place in [one.0 >> 32, one.0 & u64::from(u32::MAX)] {
                let sides = Sides {
                    front: DVec3::ZERO,
                    has_both: false,
                };
                folds.insert(place as u32, sides);
            }
        }
    }
    folds
}
