//! Which unit does each group become, and in which order?

use super::graph::{Graph, Group};
use super::grid_mesh::GridMesh;
use crate::build::built::{BuildError, BuiltUnit};
use crate::build::numbering::Numbering;
use crate::build::pages::BuiltPage;
use crate::signatures::StepMeasure;
use foveal_core::content::mesh::payload::{Cluster, MeshUnit, MeshVertex};
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::measures::contrast::Signature;
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Reverse;

/// Bits of a coordinate of a sphere's centre that count for the order.
const ORDER_BITS: u32 = 20;

/// All units in order, and the number of levels; what units add is measured under a `light` from
/// some direction, or not at all.
pub(in crate::build) fn write(
    meshes: &[GridMesh],
    graphs: &[Graph],
    textures: &[Vec<BuiltPage>],
    light: Option<DVec3>,
) -> Result<(Vec<BuiltUnit>, u8), BuildError> {
    let levels = graphs.iter().filter_map(|it| it.groups.last());
    let levels = levels.map(|root| root.level);
    let of_pages = textures.iter().flatten().map(|page| page.place.level);
    let coarsest = levels.chain(of_pages).max().unwrap_or(0);
    let mut order = Vec::new();
    for (object, (mesh, graph)) in meshes.iter().zip(graphs).enumerate() {
        for (number, group) in graph.groups.iter().enumerate() {
            let is_root = group.coarse.is_empty();
            let level = if is_root { coarsest } else { group.level };
            let along = morton(group, mesh.object.grid.step);
            let made = Made::Group(object);
            order.push((Reverse(level), made, along, number));
        }
    }
    for (texture, pages) in textures.iter().enumerate() {
        for (number, page) in pages.iter().enumerate() {
            let level = if page.coarser.is_none() {
                coarsest
            } else {
                page.place.level
            };
            let along = morton_of([
                u32::from(page.place.place[0]),
                u32::from(page.place.place[1]),
                0,
            ]);
            order.push((Reverse(level), Made::Page(texture), along, number));
        }
    }
    order.sort_unstable();
    let groups = graphs
        .iter()
        .map(|graph| vec![UnitId(0); graph.groups.len()]);
    let mut unit_of: Vec<Vec<UnitId>> = groups.collect();
    let pages = textures.iter().map(|pages| vec![UnitId(0); pages.len()]);
    let mut unit_of_page: Vec<Vec<UnitId>> = pages.collect();
    for ((_, made, _, number), unit) in order.iter().zip(0..) {
        match made {
            Made::Group(object) => unit_of[*object][*number] = UnitId(unit),
            Made::Page(texture) => unit_of_page[*texture][*number] = UnitId(unit),
        }
    }
    let measure = |mesh: &GridMesh| light.map(|light| StepMeasure::new(&mesh.object, light));
    let measures: Vec<Option<StepMeasure>> = meshes.iter().map(measure).collect();
    let units = order.par_iter().map(|(level, made, _, number)| match made {
        Made::Group(object) => {
            let place = Place {
                mesh: &meshes[*object],
                graph: &graphs[*object],
                unit_of: &unit_of[*object],
                object: *object as u16,
                measure: measures[*object].as_ref(),
            };
            place.unit(level.0, *number)
        }
        Made::Page(texture) => {
            let page = &textures[*texture][*number];
            Ok(page.unit(level.0, &unit_of_page[*texture]))
        }
    });
    Ok((units.collect::<Result<_, PackError>>()?, coarsest + 1))
}

/// What a unit is made of, and of which object or texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Made {
    Group(usize),
    Page(usize),
}

/// The place of a group's centre on a curve through space (Morton 1966).
fn morton(group: &Group, step: f64) -> u64 {
    // A grid has at most 2^16 steps: 16 parts of a step count.
    let most = f64::from((1_u32 << ORDER_BITS) - 1);
    let along = |it: f32| (f64::from(it) / step * 16.0).clamp(0.0, most) as u32;
    morton_of(group.sphere.centre.map(along))
}

/// The place of a cell on a curve through space.
fn morton_of(places: [u32; 3]) -> u64 {
    let bits = (0..ORDER_BITS).flat_map(|bit| [0, 1, 2].map(|axis| (bit, axis)));
    let bit =
        |(bit, axis): (u32, usize)| u64::from(places[axis] >> bit & 1) << (3 * bit + axis as u32);
    bits.map(bit).sum()
}

/// Where a group lies.
struct Place<'a> {
    mesh: &'a GridMesh,
    graph: &'a Graph,
    unit_of: &'a [UnitId],
    object: u16,
    measure: Option<&'a StepMeasure>,
}

impl Place<'_> {
    fn unit(&self, level: u8, number: usize) -> Result<BuiltUnit, PackError> {
        let group = &self.graph.groups[number];
        let unit_of = |cluster: &u32| {
            let group = self.graph.group_of[*cluster as usize];
            self.unit_of[group as usize]
        };
        let mut needs: Vec<UnitId> = group.coarse.iter().map(unit_of).collect();
        needs.sort_unstable();
        needs.dedup();
        let replaced = |cluster: &u32| {
            let group = self.graph.group_of[*cluster as usize] as usize;
            let of_need = self.graph.groups[group].fine.iter();
            let before = |need: &&UnitId| **need != self.unit_of[group];
            PartRef {
                need: needs.iter().take_while(before).count() as u8,
                part: of_need.take_while(|it| *it != cluster).count() as u8,
            }
        };
        let replaces = group.coarse.iter().map(replaced).collect();
        let unit = self.mesh_unit(group, replaces);
        let corners = unit.clusters.iter().map(|it| it.vertices.len());
        let mut row = UnitRow {
            kind: UnitKind::Mesh,
            object: self.object,
            centre: group.sphere.centre,
            radius: group.sphere.radius,
            error: group.error,
            samples: unit.triangles() as u32,
            vertices: corners.sum::<usize>() as u32,
            needs,
            ..UnitRow::default()
        };
        let measure = self.measure.filter(|_| !group.coarse.is_empty());
        row.signature = measure.map_or_else(Signature::default, |it| {
            let [before, after] = [&group.coarse, &group.fine].map(|it| self.triangles(it));
            it.signature([&before, &after], f64::from(group.error))
        });
        let payload = unit.write(self.mesh.object.attributes)?;
        row.replaces = unit.replaces;
        Ok(BuiltUnit {
            level,
            row,
            payload,
        })
    }

    fn triangles(&self, clusters: &[u32]) -> Vec<[MeshVertex; 3]> {
        let clusters = clusters.iter();
        let corners = clusters.flat_map(|it| self.graph.clusters[*it as usize].corners());
        let corners = corners.map(|it| self.mesh.vertices[it as usize]);
        corners.collect::<Vec<_>>().as_chunks().0.to_vec()
    }

    fn mesh_unit(&self, group: &Group, replaces: Vec<PartRef>) -> MeshUnit {
        let cluster = |it: &u32| &self.graph.clusters[*it as usize];
        let all = group.coarse.iter().chain(&group.fine);
        let count = all.map(|it| cluster(it).vertices.len()).sum();
        let mut numbering = Numbering::new(count);
        for vertex in group.coarse.iter().flat_map(|it| &cluster(it).vertices) {
            numbering.number(*vertex);
        }
        let staying = numbering.vertices.len();
        let fine = group.fine.iter().map(cluster);
        let clusters = fine.map(|it| Cluster {
            vertices: it
                .vertices
                .iter()
                .map(|it| numbering.number(*it) as u16)
                .collect(),
            triangles: it.triangles.clone(),
        });
        let clusters = clusters.collect();
        let new = numbering.vertices[staying..].iter();
        MeshUnit {
            replaces,
            staying: staying as u16,
            vertices: new.map(|it| self.mesh.vertices[*it as usize]).collect(),
            clusters,
        }
    }
}
