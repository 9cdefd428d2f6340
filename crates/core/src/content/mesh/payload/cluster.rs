//! What is a cluster of a unit?

use crate::pack::PackError;

/// Most vertices, and most triangles, of a cluster.
pub const MOST_OF_CLUSTER: usize = 128;

/// A vertex on the grid of its object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshVertex {
    /// Place on the grid.
    pub place: [u16; 3],
    /// Normal, octahedral; zeros where the object has none.
    pub normal: [i8; 2],
    /// Colour: red, green and blue as sRGB codes, and alpha; zeros where the object has none.
    pub colour: [u8; 4],
    /// Place on the textures, on the object's grid of them; zeros where it has none.
    pub uv: [u16; 2],
    /// Which of the object's textures it has, [`NO_TEXTURE`] for none; 0 where the object has none.
    pub texture: u8,
}

/// Stands for no texture of an object's.
pub const NO_TEXTURE: u8 = 255;

impl MeshVertex {
    /// A vertex that has a place alone.
    pub(super) fn at(place: [u16; 3]) -> Self {
        Self {
            place,
            ..Default::default()
        }
    }
}

/// Triangles that are shown or hidden together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cluster {
    /// The vertices by number: first those that stay, then the new ones of the unit.
    pub vertices: Vec<u16>,
    /// Triangles, by place in `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u8; 3]>,
}

/// What is wrong with a unit.
pub(super) fn wrong(what: &str, found: impl ToString, expected: impl ToString) -> PackError {
    PackError {
        field: format!("mesh unit, {what}"),
        found: found.to_string(),
        expected: expected.to_string(),
    }
}
