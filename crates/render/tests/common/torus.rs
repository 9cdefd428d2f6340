//! Which mesh do the tests draw? A torus of 16 by 16 bent squares, whose parts can be refined.

use foveal_core::content::mesh::octahedral::octahedral_from_direction;
use foveal_core::content::mesh::payload::{Attributes, Cluster, MeshUnit, MeshVertex};
use foveal_core::content::payload::PayloadView;
use foveal_core::content::scene::description::{Grid, SceneObject, Shape};
use foveal_core::content::scene::part_ref::PartRef;
use foveal_core::pack::unit::UnitId;
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_render::Coming;
use glam::{DAffine3, DVec3};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Squares round the torus, either way.
const SIDES: u16 = 16;
/// Squares of a cluster, either way: a side of the torus has four clusters.
const PATCH: u16 = 4;
/// Radius of the torus, and of its tube, in metres.
const RADII: [f64; 2] = [1.0, 0.42];
/// Half the width of the grid in metres, and its places.
const HALF: f64 = 1.5;
const PLACES: f64 = 4095.0;

/// The root of the torus.
pub const ROOT: UnitId = UnitId(0);

/// A vertex of the torus; whole numbers are corners of squares.
fn vertex([u, v]: [f64; 2]) -> MeshVertex {
    let [a, b] = [u, v].map(|it| it / f64::from(SIDES) * TAU);
    let ring = DVec3::new(a.cos(), 0.0, a.sin());
    let normal = ring * b.cos() + DVec3::Y * b.sin();
    let place = ring * RADII[0] + normal * RADII[1];
    let code = |it: f64| (127.5 + 110.0 * it) as u8;
    MeshVertex {
        place: (place + HALF)
            .to_array()
            .map(|it| (it / (2.0 * HALF) * PLACES).round() as u16),
        normal: octahedral_from_direction(normal.as_vec3().to_array()),
        colour: [
            code(a.sin()),
            code((2.0 * b).cos()),
            code((a + b).cos()),
            255,
        ],
        ..MeshVertex::default()
    }
}

fn number([u, v]: [u16; 2]) -> u16 {
    v % SIDES * SIDES + u % SIDES
}

/// The corners of a cluster's patch, row by row.
fn corners(cluster: u16) -> impl Iterator<Item = [u16; 2]> {
    let first = [cluster % 4 * PATCH, cluster / 4 * PATCH];
    (0..=PATCH).flat_map(move |v| (0..=PATCH).map(move |u| [first[0] + u, first[1] + v]))
}

/// Both triangles of each square of a patch.
fn halves() -> Vec<[u8; 3]> {
    squares()
        .flat_map(|[a, b, c, d]| [[a, d, c], [a, c, b]])
        .collect()
}

/// The corners of the squares of a patch: first, along, beyond, across.
fn squares() -> impl Iterator<Item = [u8; 4]> {
    let row = PATCH as u8 + 1;
    let cells = (0..PATCH as u8).flat_map(|v| (0..PATCH as u8).map(move |u| [u, v]));
    cells.map(move |[u, v]| {
        let a = v * row + u;
        [a, a + 1, a + row + 1, a + row]
    })
}

/// The root: sixteen clusters of 32 triangles.
pub fn root() -> MeshUnit {
    let at = |v: u16| (0..SIDES).map(move |u| vertex([f64::from(u), f64::from(v)]));
    let cluster = |cluster| Cluster {
        vertices: corners(cluster).map(number).collect(),
        triangles: halves(),
    };
    MeshUnit {
        vertices: (0..SIDES).flat_map(at).collect(),
        clusters: (0..16).map(cluster).collect(),
        ..MeshUnit::default()
    }
}

/// A cluster of the root as a root of its own, every square a cluster.
pub fn squares_of(cluster: u16) -> MeshUnit {
    let square = |square: [u8; 4]| Cluster {
        vertices: square.map(u16::from).to_vec(),
        triangles: vec![[0, 3, 2], [0, 2, 1]],
    };
    MeshUnit {
        vertices: corners(cluster)
            .map(|it| vertex(it.map(|it| f64::from(it % SIDES))))
            .collect(),
        clusters: squares().map(square).collect(),
        ..MeshUnit::default()
    }
}

/// A unit in the place of clusters of the root: every square gets a fifth vertex in its middle.
pub fn refinement(replaced: &[u8]) -> MeshUnit {
    let mut staying: Vec<u16> = Vec::new();
    for corner in replaced.iter().flat_map(|it| corners(u16::from(*it))) {
        if !staying.contains(&number(corner)) {
            staying.push(number(corner));
        }
    }
    let mut unit = MeshUnit {
        replaces: (replaced.iter())
            .map(|it| PartRef { need: 0, part: *it })
            .collect(),
        staying: staying.len() as u16,
        ..MeshUnit::default()
    };
    for patch in replaced {
        let all: Vec<[u16; 2]> = corners(u16::from(*patch)).collect();
        let place = |it: &[u16; 2]| staying.iter().position(|other| *other == number(*it));
        let mut cluster = Cluster {
            vertices: all.iter().map(|it| place(it).unwrap() as u16).collect(),
            triangles: Vec::new(),
        };
        for [a, b, c, d] in squares() {
            let middle = cluster.vertices.len() as u8;
            let new = staying.len() + unit.vertices.len();
            cluster.vertices.push(new as u16);
            let first = all[usize::from(a)].map(|it| f64::from(it) + 0.5);
            unit.vertices.push(vertex(first));
            let round = [[a, d], [d, c], [c, b], [b, a]];
            cluster
                .triangles
                .extend(round.map(|[from, to]| [from, to, middle]));
        }
        unit.clusters.push(cluster);
    }
    unit
}

/// The torus, lying flat with its middle at the origin of its space.
pub fn object(attributes: Attributes) -> SceneObject {
    SceneObject {
        name: "torus".to_owned(),
        shape: Shape::Mesh {
            leaf_triangles: 1024,
        },
        bounds: Default::default(),
        grid: Grid {
            origin: [-HALF; 3],
            step: 2.0 * HALF / PLACES,
            bits: 12,
        },
        attributes,
        colour: [0.5, 0.2, 0.1, 1.0],
        two_sided: false,
        unlit: false,
        placements: vec![DAffine3::IDENTITY.to_cols_array()],
        texturing: None,
    }
}

/// Normals and colours.
pub const ALL: Attributes = Attributes {
    normals: true,
    colours: true,
    textured: false,
};

/// The root of an object, ready to be uploaded.
pub fn coming_root(payload: &MeshUnit) -> Coming<'_> {
    Coming {
        unit: ROOT,
        object: 0,
        level: 1,
        needs: &[],
        part: None,
        payload: PayloadView::Mesh(payload),
    }
}

/// A unit that refines the root, ready to be uploaded.
pub fn coming(unit: u32, payload: &MeshUnit) -> Coming<'_> {
    Coming {
        unit: UnitId(unit),
        object: 0,
        level: 0,
        needs: &[ROOT],
        part: None,
        payload: PayloadView::Mesh(payload),
    }
}

/// A view from `position` that looks to yaw and pitch in degrees, 50 degrees wide.
pub fn view(position: [f64; 3], [yaw, pitch]: [f64; 2], size: [u32; 2]) -> EyeView {
    let [yaw, pitch] = [yaw, pitch].map(|it| Radians(it.to_radians()));
    EyeView {
        position: DVec3::from_array(position),
        axes: Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0)),
        field: Field::across(Radians(50_f64.to_radians()), size),
        size,
        eye: Default::default(),
    }
}

/// A view of all of the torus from the front and above.
pub fn from_above(size: [u32; 2]) -> EyeView {
    view([0.3, 2.2, 3.6], [-4.0, -31.0], size)
}

/// Units that would refine the root's clusters, but for two of them, and what they are worth, but
/// for one of them.
pub fn worth_by_cluster() -> (HashMap<(UnitId, u8), UnitId>, Vec<f32>) {
    let refiner = |cluster: u8| ((ROOT, cluster), UnitId(u32::from(cluster)));
    let refiners = (0..14).map(refiner).collect();
    let worth = |unit: u8| match unit {
        3 => -1.0,
        _ => f32::from(unit) / 13.0,
    };
    (refiners, (0..14).map(worth).collect())
}
