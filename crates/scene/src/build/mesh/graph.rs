//! Which groups does a mesh become, from its source to its roots?

use super::clusters::{self, GraphCluster};
use super::grid_mesh::GridMesh;
use super::groups::{locked, partition};
use super::simplify::{Simplified, simplify};
use crate::build::sphere::LocalSphere;
use foveal_core::content::mesh::payload::{MOST_CLUSTERS, MeshVertex};
use rayon::prelude::*;

/// Most levels above the source; what is left then are roots.
const MOST_LEVELS: u8 = 38;
/// How often a cluster may be in a group that cannot be simplified.
const MOST_STUCK: u8 = 2;

/// Fine clusters, and what they were simplified to.
#[derive(Clone, Debug)]
pub(in crate::build) struct Group {
    /// Its level, 0 the finest; of roots the coarsest of the object.
    pub level: u8,
    /// The fine clusters, by number.
    pub fine: Vec<u32>,
    /// The coarse clusters, by number; of a root none.
    pub coarse: Vec<u32>,
    /// How far the coarse clusters are from the source, in the object's space.
    pub error: f32,
    /// Encloses the fine clusters, and the spheres of the groups that were simplified to them.
    pub sphere: LocalSphere,
}

/// A mesh at all levels.
#[derive(Clone, Debug, Default)]
pub(in crate::build) struct Graph {
    /// All clusters.
    pub clusters: Vec<GraphCluster>,
    /// The group that each cluster is a fine one of.
    pub group_of: Vec<u32>,
    /// All groups, finest first; the last are the roots.
    pub groups: Vec<Group>,
    /// How many groups let go of attributes where they jump.
    pub permissive: u64,
}

/// The graph of a mesh that has triangles; `step` hears of triangles that are done.
pub(in crate::build) fn build(mesh: &mut GridMesh, step: &(dyn Fn(u64) + Sync)) -> Graph {
    let mut graph = Graph {
        clusters: clusters::of_source(mesh),
        ..Default::default()
    };
    let mut active: Vec<u32> = (0..graph.clusters.len() as u32).collect();
    let mut ended = Vec::new();
    let mut level = 0;
    let of_source = mesh.vertices.len();
    let mut known = None;
    while active.len() > 1 && level < MOST_LEVELS {
        let there = mesh.vertices.len() as u32;
        let groups = partition(mesh, &graph.clusters, &active);
        let locks = locked(mesh, &graph.clusters, &groups, &ended);
        let halve = |group: &Vec<u32>| {
            let fine: Vec<_> = group.iter().map(|it| graph.cluster(*it)).collect();
            let simplified = simplify(&*mesh, &fine, &locks);
            step(fine.iter().map(|it| it.triangles.len() as u64).sum());
            simplified
        };
        let simplified: Vec<_> = groups.par_iter().map(halve).collect();
        let before = graph.groups.len();
        active.clear();
        for (fine, simplified) in groups.into_iter().zip(simplified) {
            match simplified {
                Some(mut it) => {
                    it.take_into(mesh, there, &mut known);
                    active.extend(graph.add(mesh, level, fine, it));
                }
                None => graph.sort_stuck(&fine, &mut active, &mut ended),
            }
        }
        level += u8::from(graph.groups.len() > before);
    }
    ended.extend(active);
    graph.add_roots(mesh, level, &ended);
    graph.number_groups();
    mesh.reach_all(of_source);
    graph
}

impl Graph {
    fn cluster(&self, number: u32) -> &GraphCluster {
        &self.clusters[number as usize]
    }

    /// Adds a group, and returns its coarse clusters.
    fn add(&mut self, mesh: &GridMesh, level: u8, fine: Vec<u32>, it: Simplified) -> Vec<u32> {
        let number = self.groups.len() as u32;
        let first = self.clusters.len() as u32;
        let coarse: Vec<u32> = (first..first + it.clusters.len() as u32).collect();
        let own = (f64::from(it.error) * mesh.object.grid.step) as f32;
        let finer = fine.iter().filter_map(|it| self.made_by(*it));
        let error = finer.map(|it| it.error).fold(own, f32::max);
        let mut spheres = self.spheres(mesh, &fine);
        spheres.extend(it.added.iter().map(|vertex| point_at(mesh, vertex)));
        let sphere = LocalSphere::round(&spheres);
        self.groups.push(Group {
            level,
            fine,
            coarse: coarse.clone(),
            error,
            sphere,
        });
        self.clusters
            .extend(it.clusters.into_iter().map(|cluster| GraphCluster {
                made_by: Some(number),
                ..cluster
            }));
        self.permissive += u64::from(it.permissive);
        coarse
    }

    /// Clusters that could not be simplified together try with others, or end.
    fn sort_stuck(&mut self, fine: &[u32], active: &mut Vec<u32>, ended: &mut Vec<u32>) {
        for number in fine {
            let stuck = &mut self.clusters[*number as usize].stuck;
            *stuck += 1;
            match *stuck < MOST_STUCK {
                true => active.push(*number),
                false => ended.push(*number),
            }
        }
    }

    /// The group that was simplified to a cluster.
    fn made_by(&self, cluster: u32) -> Option<&Group> {
        let group = self.cluster(cluster).made_by?;
        Some(&self.groups[group as usize])
    }

    /// What a sphere round clusters must enclose: vertices of the source, and spheres of groups.
    fn spheres(&self, mesh: &GridMesh, fine: &[u32]) -> Vec<LocalSphere> {
        let mut spheres = Vec::new();
        for cluster in fine {
            match self.made_by(*cluster) {
                // A group's coarse clusters follow each other: most repeats are next to another.
                Some(group) if spheres.last() == Some(&group.sphere) => (),
                Some(group) => spheres.push(group.sphere),
                None => {
                    let vertices = self.cluster(*cluster).vertices.iter();
                    spheres.extend(vertices.map(|it| point(mesh, *it)));
                }
            }
        }
        spheres
    }

    /// Clusters that no group is simplified from any more are roots.
    fn add_roots(&mut self, mesh: &GridMesh, level: u8, ended: &[u32]) {
        let sphere = LocalSphere::round(&self.spheres(mesh, ended));
        for fine in ended.chunks(MOST_CLUSTERS) {
            self.groups.push(Group {
                level,
                fine: fine.to_vec(),
                coarse: Vec::new(),
                error: f32::INFINITY,
                sphere,
            });
        }
    }

    fn number_groups(&mut self) {
        self.group_of = vec![0; self.clusters.len()];
        for (group, number) in self.groups.iter().zip(0..) {
            for cluster in &group.fine {
                self.group_of[*cluster as usize] = number;
            }
        }
    }
}

fn point(mesh: &GridMesh, vertex: u32) -> LocalSphere {
    point_at(mesh, &mesh.vertices[vertex as usize])
}

fn point_at(mesh: &GridMesh, vertex: &MeshVertex) -> LocalSphere {
    let step = mesh.object.grid.step;
    LocalSphere {
        centre: vertex.place.map(|it| (f64::from(it) * step) as f32),
        radius: 0.0,
    }
}
