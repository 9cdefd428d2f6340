//! What do any bytes say, read as a unit of a mesh? Also the body of a fuzz target.

use foveal_core::content::mesh::cut::MeshCut;
use foveal_core::content::mesh::payload::{Attributes, MOST_CLUSTERS, MOST_OF_CLUSTER, MeshUnit};
use foveal_core::pack::unit::UnitId;

/// Reads bytes as a unit of every kind of object, and stands it where it can stand alone.
pub(crate) fn parse_anything(data: &[u8]) {
    for flags in 0..8 {
        let attributes = Attributes {
            normals: flags & 1 > 0,
            colours: flags & 2 > 0,
            textured: flags & 4 > 0,
        };
        let Ok(unit) = MeshUnit::parse(data, attributes, &[]) else {
            continue;
        };
        assert!(unit.clusters.len() <= MOST_CLUSTERS);
        let named = usize::from(unit.staying) + unit.vertices.len();
        for cluster in &unit.clusters {
            assert!(cluster.vertices.len().max(cluster.triangles.len()) <= MOST_OF_CLUSTER);
            assert!(cluster.vertices.iter().all(|it| usize::from(*it) < named));
            let mut corners = cluster.triangles.as_flattened().iter();
            assert!(corners.all(|it| usize::from(*it) < cluster.vertices.len()));
        }
        let again = unit
            .write(attributes)
            .expect("what was read can be written");
        let again = MeshUnit::parse(&again, attributes, &[]).expect("what was written can be read");
        assert_eq!(turned(again), turned(unit.clone()));
        let mut cut = MeshCut::default();
        if cut.insert(UnitId(0), &[], &unit).is_ok() {
            assert_eq!(cut.drawn().count(), unit.clusters.len());
        }
    }
}

/// The same with the corners of each triangle in one order of the three that mean the same: the
/// codec of triangles keeps no more.
fn turned(mut unit: MeshUnit) -> MeshUnit {
    let clusters = unit.clusters.iter_mut();
    for triangle in clusters.flat_map(|cluster| &mut cluster.triangles) {
        let [a, b, c] = *triangle;
        *triangle = [[a, b, c], [b, c, a], [c, a, b]]
            .into_iter()
            .min()
            .unwrap_or_default();
    }
    unit
}
