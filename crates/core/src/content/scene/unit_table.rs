//! What is told of the units of a scene before they are fetched?

use crate::pack::unit::UnitId;

/// What a unit is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnitKind {
    /// Clusters of triangles: [`MeshUnit`](crate::content::mesh::payload::MeshUnit).
    #[default]
    Mesh,
}

/// What is told of one unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitRow {
    /// What it is made of.
    pub kind: UnitKind,
    /// Number of its object.
    pub object: u16,
    /// Centre of a sphere round all that it shows, in the object's space, from the origin of its
    /// grid. The spheres of its prerequisites enclose it.
    pub centre: [f32; 3],
    /// Radius of the sphere.
    pub radius: f32,
    /// How far what it is shown in place of is from the source, in the object's space; of a root
    /// infinite. No prerequisite's is smaller.
    pub error: f32,
    /// The units that must be there first, at most 16, all with lower numbers; none that another of
    /// them needs in turn.
    pub needs: Vec<UnitId>,
}
