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
    /// What one of its samples is called.
    pub sample: &'static str,
    /// The field of results that counts those of the finest level.
    pub leaves: &'static str,
    /// Its number in the table of units.
    pub(crate) byte: u8,
    /// Width of a unit's error in pixels, of the pictures that its signature was measured in.
    pub pixels_of_error: f64,
    /// Whether it stands in space: what it covers of a view can be measured, and it belongs to one
    /// object. What does not, as a page of a texture, lies on what does.
    pub is_shape: bool,
    /// The kind of the objects that it belongs to: of what stands in space its own.
    pub objects: UnitKind,
    /// Whether a coarser level is filtered, instead of fewer samples of the source.
    pub is_filtered: bool,
    /// Whether its samples are triangles, whose sides limit how near a coarser level can be.
    pub has_triangles: bool,
    /// Whether it is on its way once it is there, from what it is shown in place of to its own
    /// places: what is measured of it changes by that.
    pub morphs: bool,
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
    sample: "triangle",
    leaves: "leaf_triangles",
    byte: 0,
    pixels_of_error: 1.0,
    is_shape: true,
    objects: UnitKind::Mesh,
    is_filtered: false,
    has_triangles: true,
    morphs: true,
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
    sample: "texel",
    leaves: "texels",
    byte: 1,
    // The pixels of a page are its texels, its error the side of the coarser level's.
    pixels_of_error: 2.0,
    is_shape: false,
    objects: UnitKind::Mesh,
    is_filtered: true,
    has_triangles: false,
    morphs: false,
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
    sample: "point",
    leaves: "points",
    byte: 2,
    pixels_of_error: 1.0,
    is_shape: true,
    objects: UnitKind::Points,
    is_filtered: false,
    has_triangles: false,
    morphs: false,
    gpu: GpuCost {
        // What is left of the last block, and where it stands.
        unit: 2048,
        root: 0,
        vertex: 0,
        sample: 12,
    },
};

impl KindFacts {
    /// What its samples are called.
    #[must_use]
    pub fn samples(&self) -> String {
        format!("{}s", self.sample)
    }
}

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

    /// Those that stand in space.
    pub fn shapes() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|it| it.facts().is_shape)
    }

    pub(crate) fn from_byte(byte: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.facts().byte == byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_means_one_kind_each_name_too_and_objects_are_of_what_stands_in_space() {
        for (at, kind) in UnitKind::ALL.into_iter().enumerate() {
            assert_eq!(UnitKind::from_byte(at as u8), Some(kind));
            let others = UnitKind::ALL.into_iter().filter(|it| *it != kind);
            let same = others.filter(|it| it.facts().name == kind.facts().name);
            assert_eq!(same.count(), 0, "{kind:?}");
            let of_objects = kind.facts().objects;
            assert_eq!(kind.facts().is_shape, of_objects == kind, "{kind:?}");
            assert!(of_objects.facts().is_shape, "{kind:?}");
        }
        assert_eq!(UnitKind::from_byte(UnitKind::ALL.len() as u8), None);
    }
}
