//! What is a unit of a scene made of, and what follows from that?
//!
//! All that selection, players and programs ask of a kind is in one table. Only parsing, building
//! and drawing tell kinds apart by name.

use crate::content::images::shape::SLOT_BYTES;

/// What a unit is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnitKind {
    /// Clusters of triangles: [`MeshUnit`](crate::content::mesh::payload::MeshUnit).
    #[default]
    Mesh,
    /// A page of a texture: [`ImagePage`](crate::content::images::payload::ImagePage).
    Image,
    /// Points of a cloud: [`PointUnit`](crate::content::points::payload::PointUnit).
    Points,
}

/// What follows from a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KindFacts {
    /// Its name in results.
    pub name: &'static str,
    /// Its number in the table of units.
    pub(crate) byte: u8,
    /// How many of the pixels that a signature was measured in an error is wide.
    pub pixels_of_error: f64,
    /// Whether it stands in space: what it covers of a view can be measured, and it belongs to one
    /// object. What does not, as a page of a texture, lies on what does.
    pub is_shape: bool,
    /// Whether a coarser level is filtered, instead of fewer samples of the source.
    pub is_filtered: bool,
    /// Whether its samples are triangles, whose sides limit how near a coarser level can be.
    pub has_triangles: bool,
    /// What it takes on the GPU, at most.
    pub gpu: GpuCost,
}

/// Bytes on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuCost {
    /// Of a unit as such.
    pub unit: u64,
    /// Of a unit that needs no other, besides.
    pub root: u64,
    /// Of each vertex.
    pub vertex: u64,
    /// Of each sample.
    pub sample: u64,
}

const MESH: KindFacts = KindFacts {
    name: "mesh",
    byte: 0,
    pixels_of_error: 1.0,
    is_shape: true,
    is_filtered: false,
    has_triangles: true,
    gpu: GpuCost {
        unit: 256,
        root: 0,
        // The vertex, and its number in a cluster.
        vertex: 20,
        // The triangle, and its corners in the list of what is drawn.
        sample: 16,
    },
};

const IMAGE: KindFacts = KindFacts {
    name: "texture",
    byte: 1,
    // The pixels of a page are its texels, its error the side of the coarser level's.
    pixels_of_error: 2.0,
    is_shape: false,
    is_filtered: true,
    has_triangles: false,
    gpu: GpuCost {
        unit: SLOT_BYTES,
        // A root is followed by the levels that are made from it.
        root: SLOT_BYTES,
        vertex: 0,
        sample: 0,
    },
};

const POINTS: KindFacts = KindFacts {
    name: "points",
    byte: 2,
    pixels_of_error: 1.0,
    is_shape: true,
    is_filtered: false,
    has_triangles: false,
    gpu: GpuCost {
        // What is left of the last block, and where it stands.
        unit: 2048,
        root: 0,
        vertex: 0,
        sample: 12,
    },
};

impl UnitKind {
    /// All kinds, in the order of their numbers.
    pub const ALL: [Self; 3] = [Self::Mesh, Self::Image, Self::Points];

    /// What follows from it.
    #[must_use]
    pub const fn facts(self) -> &'static KindFacts {
        match self {
            Self::Mesh => &MESH,
            Self::Image => &IMAGE,
            Self::Points => &POINTS,
        }
    }

    pub(crate) fn from_byte(byte: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.facts().byte == byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_means_one_kind_and_each_name_too() {
        for (at, kind) in UnitKind::ALL.into_iter().enumerate() {
            assert_eq!(UnitKind::from_byte(at as u8), Some(kind));
            let others = UnitKind::ALL.into_iter().filter(|it| *it != kind);
            let same = others.filter(|it| it.facts().name == kind.facts().name);
            assert_eq!(same.count(), 0, "{kind:?}");
        }
        assert_eq!(UnitKind::from_byte(UnitKind::ALL.len() as u8), None);
    }
}
