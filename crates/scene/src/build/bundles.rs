//! Which small parts of a scene become one object?
//!
//! The root of every object is always there. Of a model of very many small parts that would be all
//! of it; parts that are joined have one root together, and are refined where they are seen.

use super::mesh::grid_mesh::check;
use crate::source::{SourceMesh, SourceObject, SourceScene};
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// So many small objects stay apart.
const MOST_APART: usize = 256;
/// Most triangles of an object that is small: larger ones have coarse levels of their own.
const SMALL: usize = 1 << 14;
/// Most triangles of a bundle.
const MOST_TRIANGLES: usize = 1 << 18;
/// Bits of the grid of a bundle.
pub(super) const BITS: u8 = 16;
/// How many times as large as its smallest part a bundle may be, so that this part still has the
/// grid of at least 2^10 places that an object may have by itself.
const MOST_SPREAD: f64 = (1_u32 << (BITS - 10)) as f64;
/// How many times the bytes of one mesh in many places copies of it may take.
const COPIES: usize = 2;
/// Bytes of a triangle, of a place, and of an object's description, about.
const BYTES: [usize; 3] = [6, 14, 230];

/// Objects that parts were joined to.
#[derive(Debug, Default)]
pub(super) struct Bundles {
    /// Them alone, where they stand, with the materials of all.
    pub(super) scene: SourceScene,
    /// For each of these the names of its parts.
    pub(super) names: Vec<Vec<String>>,
    /// For each object of the source whether all of it is in them.
    pub(super) is_joined: Vec<bool>,
}

/// An object in one of its places.
#[derive(Clone, Debug)]
struct SourcePart {
    object: usize,
    world_from_mesh: DAffine3,
    low: DVec3,
    high: DVec3,
    triangles: usize,
}

/// What all parts of a bundle have in common: normals, two sides, no light.
type PartLooks = [bool; 3];

/// Joins the small parts of a scene, if it has very many.
pub(super) fn bundles(source: &SourceScene) -> Bundles {
    let small = source.objects.par_iter().enumerate();
    let small = small.map(|(number, object)| parts_of(source, number, object));
    let small: Vec<Option<(PartLooks, Vec<SourcePart>)>> = small.collect();
    let mut bundles = Bundles {
        is_joined: vec![false; source.objects.len()],
        ..Bundles::default()
    };
    if small.iter().flatten().count() <= MOST_APART {
        return bundles;
    }
    let mut alike: BTreeMap<PartLooks, Vec<SourcePart>> = BTreeMap::new();
    for (looks, parts) in small.into_iter().flatten() {
        alike.entry(looks).or_default().extend(parts);
    }
    let mut joined = Vec::new();
    for parts in alike.into_values() {
        split(parts, &mut joined);
    }
    joined.retain(|parts| parts.len() > 1);
    // An object whose places went several ways is whole only where none is left.
    let mut places = vec![0; source.objects.len()];
    for part in joined.iter().flatten() {
        places[part.object] += 1;
    }
    let objects = source.objects.iter().zip(&places);
    bundles.is_joined = objects
        .map(|(it, joined)| it.placements.len() == *joined)
        .collect();
    for parts in &mut joined {
        parts.retain(|part| bundles.is_joined[part.object]);
    }
    joined.retain(|parts| !parts.is_empty());
    bundles.scene.materials.clone_from(&source.materials);
    let meshes = joined.par_iter().map(|parts| joined_mesh(source, parts));
    bundles.scene.meshes = meshes.collect();
    for (mesh, parts) in joined.iter().enumerate() {
        let name = |part: &SourcePart| source.objects[part.object].name.clone();
        bundles.scene.objects.push(SourceObject {
            name: name(&parts[0]),
            mesh,
            placements: vec![DAffine3::IDENTITY],
        });
        bundles.names.push(parts.iter().map(name).collect());
    }
    bundles
}

/// The places of an object that may be joined with others: one that is small, has no texture, and
/// whose copies take little more than the object by itself.
fn parts_of(
    source: &SourceScene,
    number: usize,
    object: &SourceObject,
) -> Option<(PartLooks, Vec<SourcePart>)> {
    let mesh = source.meshes.get(object.mesh)?;
    let (triangles, places) = (mesh.triangles.len(), object.placements.len());
    let [of_triangle, of_place, of_object] = BYTES;
    let copies = triangles.saturating_mul(places).saturating_mul(of_triangle);
    let apart = triangles * of_triangle + places * of_place + of_object;
    if triangles > SMALL || copies > COPIES * apart || check(source, mesh).is_err() {
        return None;
    }
    let first = mesh.materials.first().copied().unwrap_or(0);
    let used = std::iter::once(first).chain(mesh.materials.iter().copied());
    let used = used.filter_map(|it| source.materials.get(it as usize));
    if !mesh.uvs.is_empty() && used.clone().any(|it| it.texture.is_some()) {
        return None;
    }
    let looks = [
        !mesh.normals.is_empty(),
        used.clone().any(|it| it.two_sided),
        used.clone().any(|it| it.unlit),
    ];
    let part = |world_from_mesh: &DAffine3| {
        let corners = mesh.positions.iter();
        let corners = corners.map(|it| world_from_mesh.transform_point3(*it));
        let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |box_, it| {
            (box_.0.min(it), box_.1.max(it))
        });
        let is_placed = low.is_finite() && high.is_finite() && extent(low, high) > 0.0;
        (is_placed && low.abs().max(high.abs()).max_element() <= 1e15).then_some(SourcePart {
            object: number,
            world_from_mesh: *world_from_mesh,
            low,
            high,
            triangles,
        })
    };
    let parts = object.placements.iter().map(part);
    Some((looks, parts.collect::<Option<_>>()?))
}

fn extent(low: DVec3, high: DVec3) -> f64 {
    (high - low).max_element()
}

impl SourcePart {
    fn extent(&self) -> f64 {
        extent(self.low, self.high)
    }
}

/// Splits parts, by size where these differ much, else in space, until their grid is fine enough
/// for the smallest.
fn split(mut parts: Vec<SourcePart>, into: &mut Vec<Vec<SourcePart>>) {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = parts
        .iter()
        .fold(none, |box_, it| (box_.0.min(it.low), box_.1.max(it.high)));
    let least = parts
        .iter()
        .map(SourcePart::extent)
        .fold(f64::INFINITY, f64::min);
    let most = parts.iter().map(SourcePart::extent).fold(0.0, f64::max);
    let triangles: usize = parts.iter().map(|it| it.triangles).sum();
    let is_fine = extent(low, high) <= MOST_SPREAD * least;
    if parts.len() < 2 || (is_fine && triangles <= MOST_TRIANGLES) {
        if !parts.is_empty() {
            into.push(parts);
        }
        return;
    }
    let halves = if !is_fine && most > 4.0 * least {
        let between = (least * most).sqrt();
        parts.into_iter().partition(|it| it.extent() < between)
    } else {
        let size = (high - low).to_array();
        let axis = (0..3)
            .max_by(|a, b| size[*a].total_cmp(&size[*b]))
            .unwrap_or(0);
        let middle = |it: &SourcePart| it.low[axis] + it.high[axis];
        parts.sort_by(|a, b| {
            middle(a)
                .total_cmp(&middle(b))
                .then(a.object.cmp(&b.object))
        });
        let rest = parts.split_off(parts.len() / 2);
        (parts, rest)
    };
    split(halves.0, into);
    split(halves.1, into);
}

/// The mesh of parts where they stand.
fn joined_mesh(source: &SourceScene, parts: &[SourcePart]) -> SourceMesh {
    let mesh_of = |part: &SourcePart| &source.meshes[source.objects[part.object].mesh];
    let has_colours = parts.iter().any(|part| !mesh_of(part).colours.is_empty());
    let mut joined = SourceMesh::default();
    for part in parts {
        let mesh = mesh_of(part);
        let before = joined.positions.len() as u32;
        let DAffine3 { matrix3, .. } = part.world_from_mesh;
        let at = mesh.positions.iter();
        let at = at.map(|it| part.world_from_mesh.transform_point3(*it));
        joined.positions.extend(at);
        let turned = normal_turn(matrix3);
        let normal = |it: &[f32; 3]| {
            let own = DVec3::from_array(it.map(f64::from));
            (turned * own).normalize_or(own).as_vec3().to_array()
        };
        joined.normals.extend(mesh.normals.iter().map(normal));
        if has_colours {
            let white = std::iter::repeat_n([1.0; 4], mesh.positions.len());
            match mesh.colours.is_empty() {
                true => joined.colours.extend(white),
                false => joined.colours.extend(&mesh.colours),
            }
        }
        let is_mirrored = matrix3.determinant() < 0.0;
        let corners = mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|corner| corner + before);
            if is_mirrored { [a, c, b] } else { [a, b, c] }
        });
        joined.triangles.extend(corners);
        if !source.materials.is_empty() {
            joined.materials.extend(&mesh.materials);
            joined.materials.resize(joined.triangles.len(), 0);
        }
    }
    joined
}

/// How normals turn where space turns so.
fn normal_turn(matrix: DMat3) -> DMat3 {
    let inverse = matrix.inverse().transpose();
    if inverse.is_finite() { inverse } else { matrix }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::{BuildOptions, build};
    use crate::generate::{alone, torus};

    /// A box of these sides.
    fn block(sides: [f64; 3]) -> SourceMesh {
        let corner = |k: usize| {
            DVec3::from_array([0, 1, 2].map(|axis| sides[axis] * (k >> axis & 1) as f64))
        };
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles = quads
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        SourceMesh {
            positions: (0..8).map(corner).collect(),
            triangles: triangles.collect(),
            ..SourceMesh::default()
        }
    }

    /// So many blocks in a lattice; every 50th is a tenth as large, every 7th mirrored.
    fn blocks(count: usize) -> SourceScene {
        let mut scene = SourceScene::default();
        for number in 0..count {
            let size = if number.is_multiple_of(50) { 0.05 } else { 0.5 };
            scene
                .meshes
                .push(block([size, 0.8 * size, size + 0.01 * (number % 9) as f64]));
            let at = [number % 20, number / 20 % 20, number / 400].map(|it| it as f64);
            let mirror = if number.is_multiple_of(7) { -1.0 } else { 1.0 };
            let turn = DMat3::from_diagonal(DVec3::new(mirror, 1.0, 1.0));
            scene.objects.push(SourceObject {
                name: format!("block {number}"),
                mesh: number,
                placements: vec![DAffine3::from_mat3_translation(turn, DVec3::from_array(at))],
            });
        }
        scene
    }

    #[test]
    fn very_many_small_parts_have_few_roots_together_and_all_their_triangles_and_names() {
        let source = blocks(3000);
        let built = build(&source, &BuildOptions::default(), &|_, _| ()).unwrap();
        let triangles: u64 = built.objects.iter().map(|it| it.shape.samples()).sum();
        assert_eq!(triangles, 3000 * 12);
        assert!(built.objects.len() < 70, "{}", built.objects.len());
        let roots = built.units.iter().filter(|it| it.row.needs.is_empty());
        assert!(roots.count() < 70);
        let mut names: Vec<String> = built.parts.iter().flatten().cloned().collect();
        let apart = built
            .objects
            .iter()
            .zip(&built.parts)
            .filter(|(_, parts)| parts.is_empty());
        names.extend(apart.map(|(object, _)| object.name.clone()));
        names.sort();
        let mut expected: Vec<String> = source.objects.iter().map(|it| it.name.clone()).collect();
        expected.sort();
        assert_eq!(names, expected);
        // No part is on a grid that is too coarse for it.
        for object in &built.objects {
            assert!(object.grid.step < 0.05 / 1000.0 || object.bounds.radius > 1.0);
        }
        let few = build(&blocks(200), &BuildOptions::default(), &|_, _| ()).unwrap();
        assert_eq!(few.objects.len(), 200);
    }

    #[test]
    fn a_joined_part_lies_as_it_lay_and_shows_the_same_side() {
        let source = blocks(300);
        let found = bundles(&source);
        assert!(found.is_joined.iter().filter(|it| **it).count() > 290);
        let volume = |mesh: &SourceMesh| -> f64 {
            let six = mesh.triangles.iter().map(|it| {
                let [a, b, c] = it.map(|it| mesh.positions[it as usize]);
                a.dot(b.cross(c))
            });
            six.sum::<f64>() / 6.0
        };
        let joined: f64 = found.scene.meshes.iter().map(volume).sum();
        let own = source
            .meshes
            .iter()
            .zip(&found.is_joined)
            .filter(|it| *it.1);
        let own: f64 = own.map(|(mesh, _)| volume(mesh)).sum();
        assert!((joined - own).abs() < 1e-9 * own, "{joined} {own}");
        assert!(joined > 0.0);
    }

    #[test]
    fn what_is_large_or_stands_very_often_stays_one_object() {
        let mut source = blocks(400);
        let many = (0..1000).map(|it| DAffine3::from_translation(DVec3::splat(f64::from(it))));
        source.objects[7].placements = many.collect();
        source.meshes[7] = torus(16, 8);
        let large = alone("large", torus(200, 100));
        source.objects.push(SourceObject {
            mesh: 400,
            ..large.objects[0].clone()
        });
        source.meshes.extend(large.meshes);
        let found = bundles(&source);
        assert!(!found.is_joined[7] && !found.is_joined[400] && found.is_joined[8]);
    }
}
