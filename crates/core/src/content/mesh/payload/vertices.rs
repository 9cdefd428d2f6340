//! How are the vertices of a unit written?
//!
//! First which vertices each cluster has, cluster by cluster in the order of their lists. Two
//! numbers of low bits, four bits each: for vertices that stay and for those named again. Then for
//! each vertex one of: a one and a Rice code, for one that stays, as the signed distance from one
//! after the last such (from 0); a zero and a one, for the next new one; two zeros and a Rice code,
//! for a new one out of turn, as the signed distance from one after the last such (from the first).
//!
//! Then where new vertices lie, if there are any: the first in three times 16 bits; three numbers
//! of low bits, four bits each; for each other three Rice codes, the signed distances along the
//! axes from where it is predicted. All distances wrap at 2^16; signed ones count 0, -1, 1, -2.

use super::cluster::{Cluster, MOST_OF_CLUSTER, wrong};
use crate::content::bits::{
    BitReader, BitWriter, best_low_bits, signed_from_unsigned, unsigned_from_signed,
};
use crate::pack::PackError;

/// Bits of a number of low bits.
const LOW_BITS: u32 = 4;
/// Bits of a place along an axis.
const AXIS_BITS: u32 = 16;
/// Fewest bits of a place after the first: one for each axis.
const PLACE_BITS: usize = 3;

/// A vertex of a cluster as it is written; numbers wrap at 2^16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Name {
    /// One that stays, from one after the last such.
    Staying(i16),
    /// The next new one.
    Next,
    /// A new one that was named before, from one after the last such.
    Again(i16),
}

/// What names are decoded from.
struct Names {
    /// Number of vertices that stay.
    staying: u16,
    /// The next new one.
    next: u16,
    /// One after the last that stays.
    after_staying: u16,
    /// One after the last that was named again.
    after_again: u16,
}

impl Names {
    fn new(staying: u16) -> Self {
        Self {
            staying,
            next: staying,
            after_staying: 0,
            after_again: staying,
        }
    }

    fn name(&mut self, vertex: u16) -> Name {
        let name = match vertex {
            _ if vertex < self.staying => {
                Name::Staying(vertex.wrapping_sub(self.after_staying) as i16)
            }
            _ if vertex == self.next => Name::Next,
            _ => Name::Again(vertex.wrapping_sub(self.after_again) as i16),
        };
        self.vertex(name);
        name
    }

    fn vertex(&mut self, name: Name) -> u16 {
        let (vertex, after) = match name {
            Name::Staying(from) => {
                let vertex = self.after_staying.wrapping_add_signed(from);
                (vertex, &mut self.after_staying)
            }
            Name::Next => (self.next, &mut self.next),
            Name::Again(from) => {
                let vertex = self.after_again.wrapping_add_signed(from);
                (vertex, &mut self.after_again)
            }
        };
        *after = vertex.wrapping_add(1);
        vertex
    }
}

/// Writes which vertices clusters have.
pub(super) fn write_names(clusters: &[Cluster], staying: u16, writer: &mut BitWriter) {
    let mut names = Names::new(staying);
    let vertices = clusters.iter().flat_map(|it| &it.vertices);
    let names: Vec<Name> = vertices.map(|it| names.name(*it)).collect();
    let staying = names.iter().filter_map(|it| match it {
        Name::Staying(from) => Some(unsigned_from_signed(*from)),
        _ => None,
    });
    let again = names.iter().filter_map(|it| match it {
        Name::Again(from) => Some(unsigned_from_signed(*from)),
        _ => None,
    });
    let low_bits = [best_low_bits(staying), best_low_bits(again)];
    low_bits.iter().for_each(|it| writer.plain(*it, LOW_BITS));
    for name in names {
        match name {
            Name::Staying(from) => {
                writer.plain(1, 1);
                writer.rice(unsigned_from_signed(from), low_bits[0]);
            }
            Name::Next => writer.plain(0b10, 2),
            Name::Again(from) => {
                writer.plain(0b00, 2);
                writer.rice(unsigned_from_signed(from), low_bits[1]);
            }
        }
    }
}

/// Reads which vertices clusters have, whose number is known, of so many that stay and are new.
pub(super) fn read_names(
    clusters: &mut [Cluster],
    [staying, new]: [u16; 2],
    reader: &mut BitReader<'_>,
) -> Result<(), PackError> {
    let mut names = Names::new(staying);
    let named = u32::from(staying) + u32::from(new);
    let low_bits = [reader.plain(LOW_BITS), reader.plain(LOW_BITS)];
    for cluster in clusters {
        for vertex in &mut cluster.vertices {
            let name = read_name(reader, low_bits);
            *vertex = names.vertex(name);
            if u32::from(*vertex) >= named {
                return Err(wrong("vertex", *vertex, format!("fewer than {named}")));
            }
        }
    }
    Ok(())
}

fn read_name(reader: &mut BitReader<'_>, [staying, again]: [u32; 2]) -> Name {
    match reader.next_two() {
        0b10 => {
            reader.pass(2);
            Name::Next
        }
        0b00 => {
            reader.pass(2);
            Name::Again(signed_from_unsigned(reader.rice_held(again)))
        }
        _ => {
            reader.pass(1);
            Name::Staying(signed_from_unsigned(reader.rice_held(staying)))
        }
    }
}

/// From which earlier new vertices each is predicted: the sum of the first two less the third.
///
/// By default from the one before. Where the first triangle that has it has others already known,
/// from these; where both others are, and the triangle before shares them, as a parallelogram
/// (Touma and Gotsman 1998, "Triangle mesh compression").
fn predictors(clusters: &[Cluster], [staying, new]: [u16; 2]) -> Vec<[u16; 3]> {
    let mut from: Vec<[u16; 3]> = (0..new).map(|it| [it.saturating_sub(1); 3]).collect();
    let mut is_told = vec![false; usize::from(new)];
    for cluster in clusters {
        let first = first_triangles(&cluster.triangles);
        for (at, vertex) in (0..).zip(&cluster.vertices) {
            let vertex = vertex.wrapping_sub(staying);
            // The first cluster that has a vertex stores it.
            let Some(is_told) = is_told.get_mut(usize::from(vertex)) else {
                continue;
            };
            if core::mem::replace(is_told, true) {
                continue;
            }
            let new_of = |corner: u8| cluster.vertices[usize::from(corner)].wrapping_sub(staying);
            if let Some((others, before)) = others_of(at, &first, &cluster.triangles)
                && let Some(found) = predictor(vertex, others.map(new_of), before.map(new_of))
            {
                from[usize::from(vertex)] = found;
            }
        }
    }
    from
}

/// Stands for no triangle.
const NO_TRIANGLE: u8 = u8::MAX;

/// For each vertex of a cluster the first triangle that has it.
fn first_triangles(triangles: &[[u8; 3]]) -> [u8; MOST_OF_CLUSTER] {
    let mut first = [NO_TRIANGLE; MOST_OF_CLUSTER];
    for (number, triangle) in triangles.iter().enumerate().rev() {
        for corner in triangle {
            if let Some(first) = first.get_mut(usize::from(*corner)) {
                *first = number as u8;
            }
        }
    }
    first
}

/// The other corners of the first triangle that has a corner, in turn, and those of the triangle
/// before, or of none three times the first corner.
fn others_of(
    at: u8,
    first: &[u8; MOST_OF_CLUSTER],
    triangles: &[[u8; 3]],
) -> Option<([u8; 2], [u8; 3])> {
    let number = usize::from(*first.get(usize::from(at))?);
    let [a, b, c] = *triangles.get(number)?;
    let others = match at {
        _ if a == at => [b, c],
        _ if b == at => [c, a],
        _ => [a, b],
    };
    let before = number.checked_sub(1).map(|it| triangles[it]);
    Some((others, before.unwrap_or_default()))
}

fn predictor(vertex: u16, [a, b]: [u16; 2], before: [u16; 3]) -> Option<[u16; 3]> {
    match (a < vertex, b < vertex) {
        (true, true) => {
            let is_shared = before.contains(&a) && before.contains(&b);
            let opposite = before.into_iter().find(|it| *it != a && *it != b);
            let opposite = opposite.filter(|it| is_shared && *it < vertex);
            // Without a triangle on the other side, the later of the two.
            Some(opposite.map_or([a.max(b); 3], |opposite| [a, b, opposite]))
        }
        (true, false) => Some([a; 3]),
        (false, true) => Some([b; 3]),
        (false, false) => None,
    }
}

/// Writes where new vertices lie.
pub(super) fn write_places(
    clusters: &[Cluster],
    staying: u16,
    places: &[[u16; 3]],
    writer: &mut BitWriter,
) {
    let Some((first, rest)) = places.split_first() else {
        return;
    };
    first
        .iter()
        .for_each(|it| writer.plain(u32::from(*it), AXIS_BITS));
    let from = predictors(clusters, [staying, places.len() as u16]);
    let along = |axis: usize| {
        let told = rest.iter().zip(&from[1..]);
        told.map(move |(place, from)| {
            let off = place[axis].wrapping_sub(predicted(places, *from)[axis]);
            unsigned_from_signed(off as i16)
        })
    };
    let low_bits = [0, 1, 2].map(|axis| best_low_bits(along(axis)));
    low_bits.iter().for_each(|it| writer.plain(*it, LOW_BITS));
    let [x, y, z] = [0, 1, 2].map(along);
    for ((x, y), z) in x.zip(y).zip(z) {
        writer.rice(x, low_bits[0]);
        writer.rice(y, low_bits[1]);
        writer.rice(z, low_bits[2]);
    }
}

fn predicted(places: &[[u16; 3]], from: [u16; 3]) -> [u16; 3] {
    let [a, b, c] = from.map(|it| places[usize::from(it)]);
    [0, 1, 2].map(|axis| a[axis].wrapping_add(b[axis]).wrapping_sub(c[axis]))
}

/// Reads where new vertices lie.
pub(super) fn read_places(
    clusters: &[Cluster],
    [staying, new]: [u16; 2],
    reader: &mut BitReader<'_>,
) -> Result<Vec<[u16; 3]>, PackError> {
    // Checked before room is made for them.
    if reader
        .left()
        .is_none_or(|left| left < PLACE_BITS * usize::from(new))
    {
        return Err(wrong("vertices", new, "as many as there are bytes for"));
    }
    let mut places = Vec::with_capacity(usize::from(new));
    if new == 0 {
        return Ok(places);
    }
    places.push([0; 3].map(|_: u8| reader.plain(AXIS_BITS) as u16));
    let low_bits = [0; 3].map(|_: u8| reader.plain(LOW_BITS));
    let from = predictors(clusters, [staying, new]);
    for from in &from[1..] {
        let mut place = predicted(&places, *from);
        for (axis, low) in place.iter_mut().zip(low_bits) {
            *axis = axis.wrapping_add_signed(signed_from_unsigned(reader.rice(low)));
        }
        places.push(place);
    }
    Ok(places)
}
