//! How can half as many small parts that lie apart stand for all of them?
//!
//! Collapsing edges makes such parts vanish one by one, and what they cover vanishes with them.
//! But thousands of leaves, bolts or stones are seen together even if each is too small to be seen.
//! So the larger of two neighbouring parts stays. Where the removed parts covered as much as those
//! that stay, the parts that stay grow to cover as much as both did.

use crate::build::mesh::clusters::Part;
use crate::build::mesh::grid_mesh::GridMesh;
use crate::build::numbering::Numbering;
use foveal_core::content::mesh::payload::MeshVertex;
use glam::DVec3;

/// The least number of parts that count as many.
const MANY: usize = 8;
/// The area that parts stand for may be this many times the area that is drawn.
const MOST_OWED: f64 = 2.5;
/// Small parts are looked for once less than this share of the area is left.
const LEAST_AREA: f64 = 0.9;

/// A group in which some parts stand for others.
pub(in crate::build) struct Thinned {
    /// Corners of triangles, by numbers of the part with its new vertices.
    pub corners: Vec<u32>,
    /// The new vertices, which are the last of the part.
    pub added: Vec<MeshVertex>,
    /// The largest distance of a part from the one that stands for it, in steps of the grid.
    pub error: f32,
    /// The area that it stands for, as a multiple of its own.
    pub owed: f64,
}

/// Connected triangles.
#[derive(Clone, Debug, Default)]
struct Piece {
    triangles: Vec<[u32; 3]>,
    area: f64,
    middle: DVec3,
    is_locked: bool,
}

/// Whether triangles cover clearly less than all of a part.
pub(in crate::build) fn has_lost_area(part: &Part, corners: &[u32]) -> bool {
    let all = |corners: &[u32]| -> f64 {
        let triangles = corners.as_chunks::<3>().0.iter();
        triangles.map(|it| area_of(part, it)).sum()
    };
    all(corners) < LEAST_AREA * all(&part.corners)
}

/// Halves the number of pieces of a part, which stands for `owed` times its area; `locks` says
/// which vertices stay. None where it has few pieces.
pub(in crate::build) fn thin(
    mesh: &GridMesh,
    part: &mut Part,
    locks: &[bool],
    owed: f64,
) -> Option<Thinned> {
    let pieces = pieces(mesh, part, locks);
    let free = pieces.iter().filter(|it| !it.is_locked);
    let (free, before) = free.fold((0, 0.0), |(count, area), it| (count + 1, area + it.area));
    if free < MANY {
        return None;
    }
    let (mut staying, mut after, mut error) = (Vec::new(), 0.0, 0.0_f64);
    for (piece, other) in pairs(&pieces) {
        if !piece.is_locked {
            after += piece.area;
        }
        let apart = other.map_or(0.0, |it| it.middle.distance(piece.middle));
        error = error.max(apart);
        staying.push(piece);
    }
    let mut thinned = Thinned {
        corners: Vec::new(),
        added: Vec::new(),
        error: error as f32,
        owed: owed * before / f64::max(after, f64::MIN_POSITIVE),
    };
    let grows = thinned.owed > MOST_OWED;
    let scale = thinned.owed.min(2.0 * MOST_OWED).sqrt();
    for piece in staying {
        match grows && !piece.is_locked {
            true => thinned.add(mesh, part, piece, scale),
            false => thinned.corners.extend(piece.triangles.as_flattened()),
        }
    }
    if grows {
        thinned.owed = 1.0;
    }
    Some(thinned)
}

impl Thinned {
    /// Adds a piece scaled by `scale`, with vertices of its own.
    fn add(&mut self, mesh: &GridMesh, part: &mut Part, piece: &Piece, scale: f64) {
        let corners = piece.triangles.as_flattened();
        let mut numbering = Numbering::new(corners.len());
        let of_mesh = |it: &u32| part.vertices[*it as usize];
        let numbers = corners.iter().map(|it| numbering.number(of_mesh(it)));
        let numbers: Vec<u32> = numbers.collect();
        let most = f64::from((1_u32 << mesh.object.grid.bits) - 1);
        let (centre, reach) = mesh.sphere_on_grid();
        let first = part.vertices.len() as u32;
        let next = mesh.vertices.len() as u32 + self.added.len() as u32;
        let of_mesh = |it: &u32| &mesh.vertices[*it as usize];
        let at = |it: &u32| {
            let from = DVec3::from_array(of_mesh(it).place.map(f64::from));
            let at = piece.middle + scale * (from - piece.middle);
            // The sphere round the mesh stays as it is.
            centre + (at - centre).clamp_length_max(reach)
        };
        let places: Vec<DVec3> = numbering.vertices.iter().map(at).collect();
        let low = places.iter().fold(DVec3::INFINITY, |low, it| low.min(*it));
        let high = places.iter().fold(DVec3::ZERO, |high, it| high.max(*it));
        // Vertices stay on the grid, too.
        let shift = (-low).max(DVec3::ZERO) - (high - most).max(DVec3::ZERO);
        let vertices = numbering.vertices.iter().zip(&places);
        let enlarged = vertices.map(|(vertex, at)| MeshVertex {
            place: (*at + shift)
                .round()
                .to_array()
                .map(|it| it.clamp(0.0, most) as u16),
            ..*of_mesh(vertex)
        });
        let enlarged: Vec<MeshVertex> = enlarged.collect();
        for triangle in numbers.as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|it| enlarged[it as usize].place);
            // At the edge of the grid places may coincide.
            if a != b && b != c && c != a {
                self.corners.extend(triangle.map(|it| first + it));
            }
        }
        part.vertices.extend(next..next + enlarged.len() as u32);
        let places = enlarged.iter().map(|it| it.place.map(f32::from));
        part.positions.extend(places);
        self.added.extend(enlarged);
    }
}

/// The pieces that stay, each with the one that it stands for. Of a free piece and its nearest free
/// neighbour the larger one stays.
fn pairs(pieces: &[Piece]) -> Vec<(&Piece, Option<&Piece>)> {
    let mut is_taken: Vec<bool> = pieces.iter().map(|it| it.is_locked).collect();
    let locked = pieces.iter().filter(|it| it.is_locked);
    let mut pairs: Vec<_> = locked.map(|it| (it, None)).collect();
    for (number, piece) in pieces.iter().enumerate() {
        if std::mem::replace(&mut is_taken[number], true) {
            continue;
        }
        let left = (number + 1..pieces.len()).filter(|it| !is_taken[*it]);
        let away = |it: &usize| piece.middle.distance_squared(pieces[*it].middle);
        let nearest = left.min_by(|one, other| away(one).total_cmp(&away(other)));
        let Some(nearest) = nearest else {
            pairs.push((piece, None));
            continue;
        };
        is_taken[nearest] = true;
        let other = &pieces[nearest];
        pairs.push(match other.area > piece.area {
            true => (other, Some(piece)),
            false => (piece, Some(other)),
        });
    }
    pairs
}

/// The pieces of a part that are connected by places.
fn pieces(mesh: &GridMesh, part: &Part, locks: &[bool]) -> Vec<Piece> {
    let mut numbering = Numbering::new(part.vertices.len());
    let place = |vertex: &u32| numbering.number(mesh.same_place[*vertex as usize]);
    let places: Vec<u32> = part.vertices.iter().map(place).collect();
    // Each place names one nearer to the first of its piece.
    let mut nearer: Vec<u32> = (0..numbering.vertices.len() as u32).collect();
    fn root(nearer: &mut [u32], mut at: u32) -> u32 {
        while nearer[at as usize] != at {
            let next = nearer[nearer[at as usize] as usize];
            nearer[at as usize] = next;
            at = next;
        }
        at
    }
    let triangles = part.corners.as_chunks::<3>().0;
    for triangle in triangles {
        let [a, b, c] = triangle.map(|it| root(&mut nearer, places[it as usize]));
        let least = a.min(b).min(c);
        for it in [a, b, c] {
            nearer[it as usize] = least;
        }
    }
    let mut number_of = vec![u32::MAX; nearer.len()];
    let mut pieces: Vec<Piece> = Vec::new();
    for triangle in triangles {
        let first = root(&mut nearer, places[triangle[0] as usize]) as usize;
        if number_of[first] == u32::MAX {
            number_of[first] = pieces.len() as u32;
            pieces.push(Piece::default());
        }
        let piece = &mut pieces[number_of[first] as usize];
        piece.triangles.push(*triangle);
        piece.area += area_of(part, triangle);
        let corners = triangle.map(|it| position(part, it));
        piece.middle += corners.into_iter().sum::<DVec3>() / 3.0;
        piece.is_locked |= triangle.iter().any(|it| locks[*it as usize]);
    }
    for piece in &mut pieces {
        piece.middle /= piece.triangles.len() as f64;
    }
    pieces
}

fn area_of(part: &Part, triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|it| position(part, it));
    (b - a).cross(c - a).length() / 2.0
}

fn position(part: &Part, vertex: u32) -> DVec3 {
    DVec3::from_array(part.positions[vertex as usize].map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_neighbours_the_larger_stays_and_locked_ones_stay_as_they_are() {
        let piece = |x: f64, area: f64, is_locked: bool| Piece {
            middle: DVec3::X * x,
            area,
            is_locked,
            ..Piece::default()
        };
        let pieces = [
            piece(0.0, 1.0, false),
            piece(10.0, 1.0, false),
            piece(1.0, 2.0, false),
            piece(0.5, 9.0, true),
        ];
        let told: Vec<_> = pairs(&pieces)
            .into_iter()
            .map(|(it, other)| (it.middle.x, other.map(|it| it.middle.x)))
            .collect();
        assert_eq!(told, [(0.5, None), (1.0, Some(0.0)), (10.0, None)]);
    }
}
