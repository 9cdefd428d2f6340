//! Which clusters are simplified together?

use super::clusters::{GraphCluster, adapter};
use super::grid_mesh::GridMesh;
use crate::build::numbering::Numbering;

/// Clusters of a group; up to a third more happen.
const CLUSTERS: usize = 4;

/// Clusters in groups of about four that share borders, by number.
pub(in crate::build) fn partition(
    mesh: &GridMesh,
    clusters: &[GraphCluster],
    active: &[u32],
) -> Vec<Vec<u32>> {
    if active.len() <= CLUSTERS {
        return vec![active.to_vec()];
    }
    let counts = active.iter();
    let counts = counts.map(|it| 3 * clusters[*it as usize].triangles.len() as u32);
    let counts: Vec<u32> = counts.collect();
    let vertices = active
        .iter()
        .map(|it| clusters[*it as usize].vertices.len());
    let mut numbering = Numbering::new(vertices.sum());
    let mut corners = Vec::with_capacity(counts.iter().sum::<u32>() as usize);
    for cluster in active {
        let of_cluster = clusters[*cluster as usize].corners();
        corners.extend(of_cluster.map(|it| numbering.number(mesh.same_place[it as usize])));
    }
    let place = |vertex: &u32| mesh.vertices[*vertex as usize].place.map(f32::from);
    let positions: Vec<_> = numbering.vertices.iter().map(place).collect();
    let positions = adapter(&positions);
    let mut group_of = vec![0; active.len()];
    let count = meshopt::partition_clusters_with_positions(
        &mut group_of,
        &corners,
        &counts,
        &positions,
        CLUSTERS,
    );
    let mut groups = vec![Vec::with_capacity(CLUSTERS + 1); count];
    for (cluster, group) in active.iter().zip(group_of) {
        groups[group as usize].push(*cluster);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// Whether each vertex lies, by its place, in more than one group, or in a cluster that has `ended`
/// as a root: such a cluster stays as it is, so what meets it must.
pub(in crate::build) fn locked(
    mesh: &GridMesh,
    clusters: &[GraphCluster],
    groups: &[Vec<u32>],
    ended: &[u32],
) -> Vec<bool> {
    const NONE: u32 = u32::MAX;
    const SEVERAL: u32 = u32::MAX - 1;
    let mut group_of = vec![NONE; mesh.vertices.len()];
    for (group, number) in groups.iter().zip(0..) {
        let of_group = group.iter().flat_map(|it| &clusters[*it as usize].vertices);
        for vertex in of_group {
            let group_of = &mut group_of[mesh.same_place[*vertex as usize] as usize];
            *group_of = match *group_of {
                NONE => number,
                before if before == number => number,
                _ => SEVERAL,
            };
        }
    }
    for vertex in ended.iter().flat_map(|it| &clusters[*it as usize].vertices) {
        group_of[mesh.same_place[*vertex as usize] as usize] = SEVERAL;
    }
    let places = mesh.same_place.iter();
    places.map(|it| group_of[*it as usize] == SEVERAL).collect()
}
