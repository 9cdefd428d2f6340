//! Which edges do triangles have an odd number of times?

use std::collections::HashMap;

/// A place on the grid of an object.
pub(super) type Place = [u16; 3];

/// Number of odd edges: an edge, named by its two places on the grid, is odd when an odd number of
/// triangles with three different places has it.
pub fn odd_edges(triangles: impl Iterator<Item = [[u16; 3]; 3]>) -> u64 {
    let mut odd = HashMap::new();
    for [a, b, c] in triangles.filter(has_area) {
        for edge in [edge(a, b), edge(b, c), edge(c, a)] {
            *odd.entry(edge).or_insert(false) ^= true;
        }
    }
    odd.values().filter(|is_odd| **is_odd).count() as u64
}

/// Whether a triangle has three different places.
pub(super) fn has_area([a, b, c]: &[Place; 3]) -> bool {
    a != b && b != c && c != a
}

/// The edge between two places.
pub(super) fn edge(a: Place, b: Place) -> [Place; 2] {
    [a.min(b), a.max(b)]
}
