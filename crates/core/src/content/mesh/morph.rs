//! Where is a new vertex on its way from the coarse surface to its place?
//!
//! It starts at the nearest point of the triangles that its unit is shown in place of. A point is
//! given by the corners of a triangle and their shares, so that it moves along where these are on
//! their way themselves; the vertex moves with it, and away from it by what lies between the two in
//! the end. All is in whole numbers: vertices at one place stay at one place, and
//! whatever triangles meet there go on meeting there.

use crate::content::mesh::octahedral::{direction_from_octahedral, octahedral_from_direction};
use crate::content::mesh::payload::MeshVertex;
use glam::DVec3;
use std::collections::HashMap;

#[cfg(test)]
mod tests;

/// The whole way, and the sum of a point's shares.
const WHOLE: u32 = 1 << 16;
/// What lies farther than the nearest by no more than this is as near: squares of places of the
/// grid.
const AS_NEAR: f64 = 0.25;

/// The point of the coarse surface where a new vertex starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Foot {
    /// The corners of a coarse triangle, by number in the unit: vertices that stay.
    pub(super) corners: [u16; 3],
    /// How much each corner counts, of [`WHOLE`].
    shares: [u32; 3],
    /// Where the point is once its corners are in their places, times [`WHOLE`].
    end: [u32; 3],
    /// What the surface has there.
    normal: [i8; 2],
    colour: [u8; 4],
    uv: [u16; 2],
}

impl Foot {
    /// Where the vertex that ends as `vertex` is after `share` of its way, 0 to 1, where the
    /// corners that it starts between are at these places now.
    pub(super) fn at(&self, corners: [[u16; 3]; 3], vertex: &MeshVertex, share: f64) -> MeshVertex {
        let gone = (share.clamp(0.0, 1.0) * f64::from(WHOLE)) as u32;
        let now = point_of(&self.shares, &corners);
        let place = [0, 1, 2].map(|axis| {
            let away = i64::from(vertex.place[axis]) * i64::from(WHOLE) - i64::from(self.end[axis]);
            let sum = i64::from(now[axis]) * i64::from(WHOLE) + away * i64::from(gone);
            ((sum + (1 << 31)) >> 32).clamp(0, i64::from(u16::MAX)) as u16
        });
        let shares = [WHOLE - gone, gone];
        MeshVertex {
            place,
            normal: mixed_normal(&[self.normal, vertex.normal], &shares),
            colour: mixed_colour(&[self.colour, vertex.colour], &shares),
            uv: mixed_uv(&[self.uv, vertex.uv], &shares),
            texture: vertex.texture,
        }
    }
}

/// Where the new vertices of a unit start: its `vertices`, of which those that stay come first, on
/// the `coarse` triangles, whose corners are numbers of vertices that stay.
///
/// Takes about a tenth of a microsecond for each new vertex and near triangle, and a hundredth for
/// each that is far.
pub(super) fn feet(
    vertices: &[MeshVertex],
    staying: usize,
    coarse: &[[u16; 3]],
) -> Vec<Option<Foot>> {
    let surface = Surface::new(vertices, staying, coarse);
    let mut found: HashMap<[u16; 3], Option<Found>> = HashMap::new();
    let new = vertices.iter().skip(staying);
    let feet = new.map(|vertex| {
        let found = found.entry(vertex.place);
        let found = found.or_insert_with(|| surface.nearest(vertex.place));
        found.as_ref().map(|found| surface.foot(vertex, found))
    });
    feet.collect()
}

/// A point of a surface: the corners of a triangle and their shares.
type Point = ([u16; 3], [u32; 3]);

/// The nearest point of a surface, and all that are as near.
struct Found {
    nearest: Point,
    as_near: Vec<Point>,
}

/// The triangles that a unit is shown in place of.
struct Surface<'a> {
    vertices: &'a [MeshVertex],
    /// A vertex that stays at each place that one stays at.
    staying: HashMap<[u16; 3], u16>,
    triangles: Vec<Triangle>,
}

struct Triangle {
    corners: [u16; 3],
    places: [DVec3; 3],
    low: DVec3,
    high: DVec3,
}

impl<'a> Surface<'a> {
    fn new(vertices: &'a [MeshVertex], staying: usize, coarse: &[[u16; 3]]) -> Self {
        let numbered = vertices.iter().zip(0..).take(staying);
        let triangle = |corners: &[u16; 3]| {
            let places = corners.map(|it| point(vertices[usize::from(it)].place));
            let [a, b, c] = places;
            Triangle {
                corners: *corners,
                places,
                low: a.min(b).min(c),
                high: a.max(b).max(c),
            }
        };
        Self {
            vertices,
            staying: numbered.map(|(it, number)| (it.place, number)).collect(),
            triangles: coarse.iter().map(triangle).collect(),
        }
    }

    /// The point nearest to a place; `None` where there is no triangle.
    fn nearest(&self, place: [u16; 3]) -> Option<Found> {
        let from = point(place);
        let to_box = |triangle: &Triangle| {
            let within = from.clamp(triangle.low, triangle.high);
            within.distance_squared(from)
        };
        let bounds: Vec<f64> = self.triangles.iter().map(to_box).collect();
        let nearest_box = bounds
            .iter()
            .copied()
            .zip(0..)
            .reduce(|a, b| match b.0 < a.0 {
                true => b,
                false => a,
            });
        // One that is probably near rules most others out.
        let mut least = self.point(nearest_box?.1, from).0;
        let mut near = Vec::new();
        for (number, bound) in bounds.into_iter().enumerate() {
            if bound <= least + AS_NEAR {
                let (distance, point) = self.point(number, from);
                least = least.min(distance);
                near.push((distance, point));
            }
        }
        let nearest = near.iter().find(|(distance, _)| *distance == least)?.1;
        let as_near = near.iter().filter(|it| it.0 <= least + AS_NEAR);
        Some(Found {
            // What is at the place of a vertex that stays, stays with it wherever that goes.
            nearest: match self.staying.get(&place) {
                Some(corner) => ([*corner; 3], [WHOLE, 0, 0]),
                None => nearest,
            },
            as_near: as_near.map(|it| it.1).collect(),
        })
    }

    /// The square of the distance of a place from a triangle, and the point there.
    fn point(&self, triangle: usize, from: DVec3) -> (f64, Point) {
        let Triangle {
            corners, places, ..
        } = &self.triangles[triangle];
        let shares = nearest_of(*places, from);
        let [a, b, c] = [0, 1, 2].map(|k| places[k] * shares[k]);
        let point = (*corners, whole_shares(shares));
        ((a + b + c).distance_squared(from), point)
    }

    /// Where a vertex starts. Where attributes jump there, it has those most like its own.
    fn foot(&self, vertex: &MeshVertex, found: &Found) -> Foot {
        let attributes = |(corners, shares): &Point| {
            let of = corners.map(|it| self.vertices[usize::from(it)]);
            MeshVertex {
                place: vertex.place,
                normal: mixed_normal(&of.map(|it| it.normal), shares),
                colour: mixed_colour(&of.map(|it| it.colour), shares),
                uv: mixed_uv(&of.map(|it| it.uv), shares),
                texture: of[0].texture,
            }
        };
        let (corners, shares) = found.nearest;
        let places = corners.map(|it| self.vertices[usize::from(it)].place);
        let all = found.as_near.iter().map(attributes);
        let there = all.min_by_key(|it| unlikeness(it, vertex));
        let there = there.unwrap_or(*vertex);
        Foot {
            corners,
            shares,
            end: point_of(&shares, &places),
            normal: there.normal,
            colour: there.colour,
            // A place on one texture is none on another.
            uv: match there.texture == vertex.texture {
                true => there.uv,
                false => vertex.uv,
            },
        }
    }
}

/// A point between corners, times [`WHOLE`].
fn point_of(shares: &[u32; 3], corners: &[[u16; 3]; 3]) -> [u32; 3] {
    [0, 1, 2].map(|axis| {
        let of_corner = |k: usize| shares[k] * u32::from(corners[k][axis]);
        [0, 1, 2].map(of_corner).iter().sum()
    })
}

/// How far the attributes of two vertices are from each other: first whether they have one texture.
fn unlikeness(a: &MeshVertex, b: &MeshVertex) -> (bool, u32) {
    let normals = a.normal.iter().zip(b.normal);
    let normals = normals.map(|(a, b)| u32::from(a.abs_diff(b)));
    let colours = a.colour.iter().zip(b.colour);
    let colours = colours.map(|(a, b)| u32::from(a.abs_diff(b)));
    let uvs = a.uv.iter().zip(b.uv);
    let uvs = uvs.map(|(a, b)| u32::from(a.abs_diff(b)) / 16);
    (
        a.texture != b.texture,
        normals.chain(colours).chain(uvs).sum(),
    )
}

fn point(place: [u16; 3]) -> DVec3 {
    DVec3::from_array(place.map(f64::from))
}

/// The shares of a triangle's corners in its point nearest to another. Source: Ericson 2005,
/// "Real-time collision detection", section 5.1.5.
fn nearest_of([a, b, c]: [DVec3; 3], from: DVec3) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let [d1, d2] = [ab, ac].map(|it| it.dot(from - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let [d3, d4] = [ab, ac].map(|it| it.dot(from - b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let of_c = d1 * d4 - d3 * d2;
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        let along = d1 / (d1 - d3);
        return [1.0 - along, along, 0.0];
    }
    let [d5, d6] = [ab, ac].map(|it| it.dot(from - c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let of_b = d5 * d2 - d1 * d6;
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        let along = d2 / (d2 - d6);
        return [1.0 - along, 0.0, along];
    }
    let of_a = d3 * d6 - d5 * d4;
    let (to_b, to_c) = (d4 - d3, d5 - d6);
    if of_a <= 0.0 && to_b >= 0.0 && to_c >= 0.0 && to_b + to_c > 0.0 {
        let along = to_b / (to_b + to_c);
        return [0.0, 1.0 - along, along];
    }
    let all = of_a + of_b + of_c;
    if all > 0.0 {
        [of_a / all, of_b / all, of_c / all]
    } else {
        // A triangle without area whose corners lie in a row, and rounding.
        [1.0, 0.0, 0.0]
    }
}

/// Shares in whole numbers, of [`WHOLE`].
fn whole_shares([_, b, c]: [f64; 3]) -> [u32; 3] {
    let [b, c] = [b, c].map(|it| libm::round(it.clamp(0.0, 1.0) * f64::from(WHOLE)) as u32);
    let c = c.min(WHOLE - b);
    [WHOLE - b - c, b, c]
}

fn mixed_normal(normals: &[[i8; 2]], shares: &[u32]) -> [i8; 2] {
    if normals.iter().all(|it| *it == normals[0]) {
        return normals[0];
    }
    let mut sum = [0.0; 3];
    for (normal, share) in normals.iter().zip(shares) {
        let direction = direction_from_octahedral(*normal);
        sum = [0, 1, 2].map(|k| sum[k] + direction[k] * *share as f32);
    }
    octahedral_from_direction(sum)
}

fn mixed_uv(uvs: &[[u16; 2]], shares: &[u32]) -> [u16; 2] {
    [0, 1].map(|k| {
        let axis = uvs.iter().zip(shares);
        let sum: u64 = axis
            .map(|(it, share)| u64::from(it[k]) * u64::from(*share))
            .sum();
        ((sum + u64::from(WHOLE / 2)) / u64::from(WHOLE)) as u16
    })
}

fn mixed_colour(colours: &[[u8; 4]], shares: &[u32]) -> [u8; 4] {
    [0, 1, 2, 3].map(|k| {
        let channel = colours.iter().zip(shares);
        let sum: u32 = channel.map(|(it, share)| u32::from(it[k]) * share).sum();
        ((sum + WHOLE / 2) / WHOLE) as u8
    })
}
