//! Which meshes follow from numbers alone, for tests and benchmarks?

use crate::source::{SourceMesh, SourceObject, SourceScene};
use glam::{DAffine3, DVec3};
use std::f64::consts::TAU;

/// A scene of one mesh that stands where it is.
#[must_use]
pub fn alone(name: &str, mesh: SourceMesh) -> SourceScene {
    let object = SourceObject {
        name: name.to_owned(),
        mesh: 0,
        placements: vec![DAffine3::IDENTITY],
    };
    SourceScene {
        objects: vec![object],
        meshes: vec![mesh],
        ..Default::default()
    }
}

/// A closed torus with bumps: twice `around` times `along` triangles.
///
/// ```
/// let torus = foveal_scene::generate::torus(16, 8);
/// assert_eq!(torus.triangles.len(), 256);
/// ```
#[must_use]
pub fn torus(around: u32, along: u32) -> SourceMesh {
    let vertices = (0..around).flat_map(|u| (0..along).map(move |v| (u, v)));
    let position = |(u, v)| {
        let [u, v] = [
            f64::from(u) / f64::from(around),
            f64::from(v) / f64::from(along),
        ];
        let bump = 1.0 + 0.1 * (5.0 * TAU * u).sin() * (3.0 * TAU * v).cos();
        let (ring, height) = (2.0 + bump * (TAU * v).cos(), bump * (TAU * v).sin());
        DVec3::new(ring * (TAU * u).cos(), height, ring * (TAU * u).sin())
    };
    SourceMesh {
        positions: vertices.map(position).collect(),
        triangles: cells(around, along, |u, v| u % around * along + v % along),
        ..Default::default()
    }
}

/// Two triangles for each cell of a grid of vertices, whose rows have `columns`.
pub(crate) fn cells(rows: u32, columns: u32, at: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let pair = |(row, column)| {
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
        [[a, b, c], [c, b, d]]
    };
    cells.flat_map(pair).collect()
}

/// A closed unit sphere of twice `around` times `along - 1` triangles, with normals, whose places
/// on textures run once round it: at the seam, and at the poles, vertices stand several times.
///
/// ```
/// let sphere = foveal_scene::generate::textured_sphere(16, 8);
/// assert_eq!((sphere.triangles.len(), sphere.uvs.len()), (224, 17 * 9));
/// ```
#[must_use]
pub fn textured_sphere(around: u32, along: u32) -> SourceMesh {
    let mut mesh = SourceMesh::default();
    for (u, v) in (0..=around).flat_map(|u| (0..=along).map(move |v| (u, v))) {
        let turn = TAU * f64::from(u % around) / f64::from(around);
        let fall = 0.5 * TAU * f64::from(v) / f64::from(along);
        // At the poles all meet in one place.
        let ring = if v == 0 || v == along {
            0.0
        } else {
            fall.sin()
        };
        let at = DVec3::new(-ring * turn.cos(), fall.cos(), ring * turn.sin());
        mesh.positions.push(at);
        mesh.normals.push(at.as_vec3().to_array());
        let uv = [
            f64::from(u) / f64::from(around),
            f64::from(v) / f64::from(along),
        ];
        mesh.uvs.push(uv.map(|it| it as f32));
    }
    let cells = cells(along, around, |v, u| u * (along + 1) + v);
    let is_flat = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|it| mesh.positions[it as usize]);
        a == b || b == c || c == a
    };
    mesh.triangles = cells.into_iter().filter(|it| !is_flat(it)).collect();
    mesh
}
