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
