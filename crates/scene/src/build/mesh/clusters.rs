//! Into which clusters do triangles fall?

use super::grid_mesh::GridMesh;
use crate::build::numbering::Numbering;
use meshopt::VertexDataAdapter;
use rayon::prelude::*;
use std::io::Cursor;

/// Most triangles of a cluster.
pub(in crate::build) const TRIANGLES: usize = 64;
/// Most vertices of a cluster.
const VERTICES: usize = 64;
/// Fewest triangles of a cluster that is split for being long.
const FEWEST: usize = TRIANGLES / 3;
/// How much larger than a full one a cluster may get before it is split: as meshoptimizer's
/// clusterlod has it.
const SPLIT: f32 = 2.0;
/// How hard clusters are put in order for the codec: meshoptimizer calls 3 the sweet spot.
const ORDER_LEVEL: u8 = 3;
/// Triangles of a part of a mesh that is cut into clusters on its own.
const PART: usize = 1 << 14;
/// How often such a part may look at a triangle before it is halved: of a regular mesh some 18
/// times; where very many meet at a corner it would be as often as there are triangles.
const MOST_LOOKS: u64 = 256;
/// Triangles of a part that is not halved for that.
const FEW: usize = 1 << 9;

/// Triangles that are shown or hidden together.
#[derive(Clone, Debug, Default)]
pub(in crate::build) struct GraphCluster {
    /// Vertices of the mesh.
    pub vertices: Vec<u32>,
    /// Triangles, by place in `vertices`.
    pub triangles: Vec<[u8; 3]>,
    /// The group that was simplified to it; none where it is of the source.
    pub made_by: Option<u32>,
    /// How often a group that it was in could not be simplified.
    pub stuck: u8,
    /// The area that it stands for, as a multiple of its own; 0 where nothing is owed.
    pub owed: f32,
}

impl GraphCluster {
    /// The corners of its triangles, as vertices of the mesh.
    pub(in crate::build) fn corners(&self) -> impl Iterator<Item = u32> {
        let corners = self.triangles.as_flattened().iter();
        corners.map(|corner| self.vertices[usize::from(*corner)])
    }
}

/// A part of a mesh with vertices of its own.
pub(in crate::build) struct Part {
    /// The vertices of the mesh by their numbers here.
    pub vertices: Vec<u32>,
    /// Corners of triangles, by numbers here.
    pub corners: Vec<u32>,
    /// Places on the grid.
    pub positions: Vec<[f32; 3]>,
}

impl Part {
    /// The part of a mesh that has these corners of triangles.
    ///
    /// About so many vertices are expected.
    pub(in crate::build) fn new(
        mesh: &GridMesh,
        corners: impl Iterator<Item = u32>,
        about: usize,
    ) -> Self {
        let mut numbering = Numbering::new(about);
        let corners = corners.map(|it| numbering.number(it)).collect();
        let vertices = numbering.vertices;
        let place = |vertex: &u32| mesh.vertices[*vertex as usize].place.map(f32::from);
        Self {
            positions: vertices.iter().map(place).collect(),
            vertices,
            corners,
        }
    }

    /// How often cutting it into clusters looks at a triangle, about: for each one at all that
    /// share a corner with it.
    fn looks(&self) -> u64 {
        let mut round = vec![0_u64; self.vertices.len()];
        for corner in &self.corners {
            round[*corner as usize] += 1;
        }
        round.iter().map(|it| it * it).sum()
    }

    /// The clusters that some of its triangles, named by corners, fall into.
    pub(in crate::build) fn clusters(&self, corners: &[u32]) -> Vec<GraphCluster> {
        let positions = adapter(&self.positions);
        let meshlets = meshopt::build_meshlets_flex(
            corners, &positions, VERTICES, FEWEST, TRIANGLES, 0.0, SPLIT,
        );
        let cluster = |meshlet: meshopt::Meshlet<'_>| {
            let mut vertices: Vec<u32> = meshlet.vertices.to_vec();
            let mut triangles = meshlet.triangles.to_vec();
            meshopt::optimize_meshlet_level(&mut vertices, &mut triangles, ORDER_LEVEL);
            let vertices = vertices.iter().map(|it| self.vertices[*it as usize]);
            GraphCluster {
                vertices: vertices.collect(),
                triangles: triangles.as_chunks().0.to_vec(),
                ..Default::default()
            }
        };
        meshlets.iter().map(cluster).collect()
    }
}

/// Positions as meshoptimizer takes them.
pub(in crate::build) fn adapter(positions: &[[f32; 3]]) -> VertexDataAdapter<'_> {
    VertexDataAdapter {
        reader: Cursor::new(meshopt::typed_to_bytes(positions)),
        vertex_count: positions.len(),
        vertex_stride: size_of::<[f32; 3]>(),
        position_offset: 0,
    }
}

/// The clusters of a whole mesh.
pub(in crate::build) fn of_source(mesh: &GridMesh) -> Vec<GraphCluster> {
    let middle = |triangle: &[u32; 3]| {
        let places = triangle.map(|it| mesh.vertices[it as usize].place.map(u32::from));
        let along = |axis: usize| places.iter().map(|place| place[axis]).sum();
        [along(0), along(1), along(2)]
    };
    let triangles = mesh.triangles.par_iter();
    let mut triangles: Vec<_> = triangles.map(|it| (middle(it), *it)).collect();
    of_triangles(mesh, &mut triangles)
}

/// The clusters of triangles, with their middles: halved along the longest axis until they are
/// few, so that many threads can work on them, and none looks at a triangle too often.
fn of_triangles(mesh: &GridMesh, triangles: &mut [([u32; 3], [u32; 3])]) -> Vec<GraphCluster> {
    if triangles.len() <= PART {
        let corners = triangles.iter().flat_map(|(_, corners)| *corners);
        let part = Part::new(mesh, corners, triangles.len());
        if triangles.len() <= FEW || part.looks() <= MOST_LOOKS * triangles.len() as u64 {
            return part.clusters(&part.corners);
        }
    }
    let extent = |axis: usize| {
        let along = triangles.iter().map(|(middle, _)| middle[axis]);
        along.clone().max().unwrap_or(0) - along.min().unwrap_or(0)
    };
    let longest = [0, 1, 2].map(extent);
    let axis = (0..3).max_by_key(|axis| longest[*axis]).unwrap_or(0);
    let half = triangles.len() / 2;
    triangles.select_nth_unstable_by_key(half, |(middle, corners)| (middle[axis], *corners));
    let (low, high) = triangles.split_at_mut(half);
    let (mut low, high) = rayon::join(|| of_triangles(mesh, low), || of_triangles(mesh, high));
    low.extend(high);
    low
}
