//! Which meshes are builds tried on?

use crate::generate::{self, cells};
use crate::source::{Material, SourceMesh, SourceScene};
use glam::DVec3;
use std::f64::consts::TAU;

fn source(mesh: SourceMesh, materials: Vec<Material>) -> SourceScene {
    SourceScene {
        materials,
        ..generate::alone("object", mesh)
    }
}

/// A closed torus with bumps: twice `around` times `along` triangles.
pub(crate) fn torus(around: u32, along: u32) -> SourceScene {
    source(generate::torus(around, along), Vec::new())
}

/// A sphere with a seam: normals lie askew, and colours differ, on its two sides.
pub(crate) fn sphere(around: u32, along: u32) -> SourceScene {
    let vertices = (0..=around).flat_map(|u| (0..=along).map(move |v| (u, v)));
    let mut mesh = SourceMesh::default();
    for (u, v) in vertices {
        let seam = f64::from(u) / f64::from(around);
        let turn = TAU * f64::from(u % around) / f64::from(around);
        let fall = 0.5 * TAU * f64::from(v) / f64::from(along);
        // At the poles all meet in one place.
        let ring = if v == 0 || v == along {
            0.0
        } else {
            fall.sin()
        };
        let at = DVec3::new(ring * turn.cos(), fall.cos(), ring * turn.sin());
        mesh.positions.push(at);
        let askew = (at + DVec3::Y * 0.3 * seam).normalize();
        mesh.normals.push(askew.as_vec3().to_array());
        mesh.colours
            .push([seam as f32, 1.0 - seam as f32, 0.5, 1.0]);
    }
    mesh.triangles = cells(around, along, |u, v| u * (along + 1) + v);
    source(mesh, Vec::new())
}

/// An open sheet with waves.
pub(crate) fn sheet(side: u32) -> SourceScene {
    let vertices = (0..=side).flat_map(|u| (0..=side).map(move |v| (u, v)));
    let position = |(u, v)| {
        let [x, z] = [u, v].map(|it: u32| f64::from(it) / f64::from(side));
        DVec3::new(x, 0.05 * (9.0 * x).sin() * (7.0 * z).cos(), z)
    };
    let mesh = SourceMesh {
        positions: vertices.map(position).collect(),
        triangles: cells(side, side, |u, v| u * (side + 1) + v),
        ..Default::default()
    };
    source(mesh, Vec::new())
}

/// A cube whose sides have two materials in turn; each side has vertices of its own.
pub(crate) fn two_materials(side: u32) -> SourceScene {
    let mut mesh = SourceMesh::default();
    for face in 0..6_u32 {
        let first = mesh.positions.len() as u32;
        let out = if face % 2 == 0 { 1.0 } else { -1.0 };
        let axis = (face / 2) as usize;
        for (u, v) in (0..=side).flat_map(|u| (0..=side).map(move |v| (u, v))) {
            let mut at = [0.0; 3];
            at[axis] = out;
            at[(axis + 1) % 3] = out * (2.0 * f64::from(u) / f64::from(side) - 1.0);
            at[(axis + 2) % 3] = 2.0 * f64::from(v) / f64::from(side) - 1.0;
            mesh.positions.push(DVec3::from_array(at));
        }
        let of_face = cells(side, side, |u, v| first + u * (side + 1) + v);
        mesh.materials.extend(vec![face / 3; of_face.len()]);
        mesh.triangles.extend(of_face);
    }
    let colours = [[1.0, 0.0, 0.0, 1.0], [0.0, 0.2, 1.0, 0.5]];
    let materials = colours.map(|colour| Material {
        colour,
        ..Default::default()
    });
    source(mesh, materials.to_vec())
}

/// Triangles that all share one edge, a zero-area one, and one twice.
pub(crate) fn fan(blades: u32) -> SourceScene {
    let mut mesh = SourceMesh {
        positions: vec![DVec3::ZERO, DVec3::Y],
        ..Default::default()
    };
    for blade in 0..blades {
        let turn = TAU * f64::from(blade) / f64::from(blades);
        mesh.positions.push(DVec3::new(turn.cos(), 0.5, turn.sin()));
        mesh.triangles.push([0, 1, blade + 2]);
    }
    mesh.triangles.extend([[0, 1, 2], [0, 0, 3]]);
    source(mesh, Vec::new())
}

/// A closed torus on which every triangle has vertices and a colour of its own.
pub(crate) fn mosaic(around: u32, along: u32) -> SourceScene {
    let whole = generate::torus(around, along);
    let mut mesh = SourceMesh::default();
    for (triangle, number) in whole.triangles.iter().zip(0_u32..) {
        let shade = |turn: u32| f64::from(number * turn % 97) as f32 / 96.0;
        let colour = [shade(31), shade(53), shade(71), 1.0];
        mesh.triangles.push([0, 1, 2].map(|it| 3 * number + it));
        for corner in triangle {
            mesh.positions.push(whole.positions[*corner as usize]);
            mesh.colours.push(colour);
        }
    }
    source(mesh, Vec::new())
}

/// A closed torus with blades on one of its edges.
pub(crate) fn bladed_torus(around: u32, along: u32, blades: u32) -> SourceScene {
    let mut mesh = generate::torus(around, along);
    let [from, to, _] = mesh.triangles[0];
    let far = mesh.positions.len() as u32 / 2;
    let blades = (0..blades).map(|blade| [from, to, far + blade]);
    mesh.triangles.extend(blades);
    source(mesh, Vec::new())
}

/// Tetrahedra that lie about.
pub(crate) fn many_pieces(count: u32) -> SourceScene {
    let mut mesh = SourceMesh::default();
    for piece in 0..count {
        let first = mesh.positions.len() as u32;
        let at = DVec3::new(
            f64::from(piece % 10),
            f64::from(piece / 10 % 10),
            f64::from(piece / 100),
        );
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        mesh.positions.extend(corners.map(|it| at + 0.5 * it));
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        mesh.triangles
            .extend(triangles.map(|it| it.map(|corner| first + corner)));
    }
    source(mesh, Vec::new())
}

/// A triangle.
pub(crate) fn triangle() -> SourceScene {
    let mesh = SourceMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        triangles: vec![[0, 1, 2]],
        ..Default::default()
    };
    source(mesh, Vec::new())
}

/// All of these, by name.
pub(crate) fn all_meshes() -> Vec<(&'static str, SourceScene)> {
    vec![
        ("torus", torus(96, 48)),
        ("sphere", sphere(64, 32)),
        ("sheet", sheet(60)),
        ("cube", two_materials(16)),
        ("fan", fan(40)),
        ("mosaic", mosaic(48, 24)),
        ("blades", bladed_torus(48, 24, 60)),
        ("pieces", many_pieces(1000)),
        ("triangle", triangle()),
    ]
}
