//! Where does a cluster lie, and which way does it face?

use foveal_core::content::mesh::cut::PlacedUnit;
use foveal_core::content::mesh::payload::MeshVertex;
use glam::Vec3;

/// The spread of triangles that face so many ways that some may be seen from anywhere.
const ANY_WAY: f32 = 2.0;
/// The least cosine between the axis of a cone and a normal in it for which the cone is used.
const LEAST_COSINE: f32 = 0.1;
/// What rounding takes from a sphere at most, in places of the grid.
const SLACK: f32 = 0.5;
/// What rounding takes from a cone at most, as a sine.
const SPREAD_SLACK: f32 = 1e-3;

/// A sphere round a cluster and a cone round the normals of its triangles, on its object's grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ClusterBounds {
    /// Middle of the sphere.
    pub(crate) centre: Vec3,
    /// Radius of the sphere.
    pub(crate) radius: f32,
    /// Unit axis of the cone.
    pub(crate) axis: Vec3,
    /// Sine of the largest angle between the axis and a normal; more than 1 without a cone.
    pub(crate) spread: f32,
}

impl ClusterBounds {
    /// Of what may be anywhere and face any way.
    pub(crate) const ANYWHERE: Self = Self {
        centre: Vec3::ZERO,
        radius: 1e9,
        axis: Vec3::ZERO,
        spread: ANY_WAY,
    };
}

/// The bounds of every cluster of a unit.
pub(crate) fn bounds_of(placed: &PlacedUnit) -> Vec<ClusterBounds> {
    let clusters = 0..placed.clusters.len();
    let triangles = |cluster| placed.triangles(cluster).collect::<Vec<_>>();
    clusters
        .map(|it| bounds_of_cluster(&triangles(it)))
        .collect()
}

/// The bounds of triangles.
fn bounds_of_cluster(triangles: &[[MeshVertex; 3]]) -> ClusterBounds {
    let corners = triangles.as_flattened().iter().map(place);
    let low = corners.clone().reduce(Vec3::min).unwrap_or_default();
    let high = corners.clone().reduce(Vec3::max).unwrap_or_default();
    let centre = (low + high) / 2.0;
    let radius = corners.map(|it| it.distance(centre)).fold(0.0, f32::max);
    let normals: Vec<Vec3> = triangles.iter().filter_map(normal).collect();
    let axis = normals.iter().sum::<Vec3>().normalize_or_zero();
    let least = normals.iter().map(|it| it.dot(axis)).fold(1.0, f32::min);
    ClusterBounds {
        centre,
        radius: radius + SLACK,
        axis,
        spread: match least > LEAST_COSINE {
            true => (1.0 - least * least).max(0.0).sqrt() + SPREAD_SLACK,
            false => ANY_WAY,
        },
    }
}

fn place(vertex: &MeshVertex) -> Vec3 {
    Vec3::from_array(vertex.place.map(f32::from))
}

/// The unit normal of a triangle; `None` where it has no area.
fn normal(triangle: &[MeshVertex; 3]) -> Option<Vec3> {
    let [a, b, c] = [0, 1, 2].map(|k| place(&triangle[k]));
    (b - a).cross(c - a).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(places: [[u16; 3]; 3]) -> [MeshVertex; 3] {
        places.map(|place| MeshVertex {
            place,
            ..MeshVertex::default()
        })
    }

    #[test]
    fn a_flat_cluster_faces_one_way_and_a_folded_one_any_way() {
        let flat = triangle([[0, 0, 0], [10, 0, 0], [0, 10, 0]]);
        let bounds = bounds_of_cluster(&[flat]);
        assert_eq!(bounds.axis, Vec3::Z);
        assert!(bounds.spread < 0.01, "{bounds:?}");
        assert!(bounds.centre.distance(Vec3::new(5.0, 5.0, 0.0)) < 1e-6);
        let [a, b, c] = flat;
        let both = bounds_of_cluster(&[flat, [a, c, b]]);
        assert_eq!(both.spread, ANY_WAY);
    }
}
