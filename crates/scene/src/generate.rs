//! Which meshes and clouds follow from numbers alone, for tests and benchmarks?

use crate::source::{SourceCloud, SourceMesh, SourceObject, SourceScene};
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

/// A closed rope of three strands in a trefoil knot, each strand with fibres and a colour of its
/// own: twice `along` times `around` triangles.
///
/// ```
/// let knot = foveal_scene::generate::knot(60, 12);
/// assert_eq!((knot.triangles.len(), knot.colours.len()), (1440, 720));
/// ```
#[must_use]
pub fn knot(along: u32, around: u32) -> SourceMesh {
    let mut mesh = SourceMesh {
        triangles: cells(along, around, |u, v| u % along * around + v % around),
        ..Default::default()
    };
    for u in 0..along {
        let turn = TAU * f64::from(u) / f64::from(along);
        let centre = trefoil(turn);
        let tangent = (trefoil(turn + 1e-4) - trefoil(turn - 1e-4)).normalize();
        // Its curve never runs along this direction.
        let across = tangent.cross(DVec3::new(0.13, 0.2, 0.97)).normalize();
        let up = tangent.cross(across);
        for v in 0..around {
            let angle = TAU * f64::from(v) / f64::from(around);
            let (radius, colour) = rope(turn, angle);
            let out = across * angle.cos() + up * angle.sin();
            mesh.positions.push(centre + out * radius);
            mesh.colours.push(colour);
        }
    }
    mesh
}

/// A closed curve with three crossings.
fn trefoil(turn: f64) -> DVec3 {
    DVec3::new(
        turn.sin() + 2.0 * (2.0 * turn).sin(),
        turn.cos() - 2.0 * (2.0 * turn).cos(),
        -1.15 * (3.0 * turn).sin(),
    )
}

/// Radius and colour of the rope at an angle of its cross-section, at a turn along its curve.
fn rope(turn: f64, angle: f64) -> (f64, [f32; 4]) {
    /// Strands, and how often they wind round the rope; a multiple of them closes it.
    const STRANDS: f64 = 3.0;
    const WINDS: f64 = 21.0;
    /// Distance of a strand's middle from the rope's, and its radius.
    const OFF: f64 = 0.33;
    const STRAND: f64 = 0.30;
    /// Linear light of each strand.
    const COLOURS: [[f64; 3]; 3] = [[0.62, 0.36, 0.15], [0.10, 0.33, 0.38], [0.60, 0.55, 0.44]];
    let place = (angle / TAU * STRANDS + turn / TAU * WINDS).rem_euclid(STRANDS);
    let strand = place.floor();
    let away = (place - strand - 0.5) * TAU / STRANDS;
    let side = OFF * away.sin();
    let round = (STRAND * STRAND - side * side).max(0.0).sqrt();
    // Fibres wind round a strand the other way.
    let fibres = (90.0 * away - 400.0 * turn).sin();
    let yarns = (16.0 * away + 150.0 * turn).sin();
    let radius = OFF * away.cos() + round + 0.006 * fibres + 0.011 * yarns;
    // Little light reaches the grooves between strands.
    let open = 0.25 + 0.75 * (away * STRANDS / 2.0).cos().max(0.0).powf(0.6);
    let light = open * (1.0 + 0.16 * yarns + 0.14 * fibres);
    let [r, g, b] = COLOURS[strand as usize % COLOURS.len()].map(|it| (it * light) as f32);
    (radius, [r, g, b, 1.0])
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

/// Numbers from 0 to 1 that follow from a seed.
fn scattered(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        // Steele et al. 2014, "Fast splittable pseudorandom number generators".
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ mixed >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// So many triangles round one edge, like the pages of a book that stands open.
#[must_use]
pub fn book(pages: u32) -> SourceMesh {
    let page = |page: u32| {
        let turn = TAU * f64::from(page) / f64::from(pages);
        DVec3::new(turn.cos(), 0.0, turn.sin())
    };
    SourceMesh {
        positions: [DVec3::NEG_Y, DVec3::Y]
            .into_iter()
            .chain((0..pages).map(page))
            .collect(),
        triangles: (0..pages).map(|page| [0, 1, page + 2]).collect(),
        ..Default::default()
    }
}

/// A cloud of so many points that all lie at one place.
#[must_use]
pub fn one_place(points: u32) -> SourceCloud {
    SourceCloud::on_grid("one place", &vec![DVec3::ZERO; points as usize])
}

/// A cloud of so many points on a torus with coloured rings, in millimetres.
#[must_use]
pub fn cloud_of_torus(points: u32) -> SourceCloud {
    let mut any = scattered(1);
    let mut cloud = SourceCloud {
        name: "torus".to_owned(),
        placements: vec![DAffine3::IDENTITY],
        scale: [0.001; 3],
        ..SourceCloud::default()
    };
    for _ in 0..points {
        let [u, v] = [TAU * any(), TAU * any()];
        let ring = 2.0 + 0.7 * v.cos();
        let off = 0.002 * any();
        let at = [
            ring * u.cos() + off,
            0.7 * v.sin() + off,
            ring * u.sin() - off,
        ];
        cloud.places.push(at.map(|it| (it * 1000.0).round() as i32));
        let stripe = if (12.0 * u).sin() > 0.0 { 180.0 } else { 60.0 };
        let code = |light: f64| ((light + 12.0 * any()) as u16).min(255) * 257;
        let colour = [stripe, 100.0 + 80.0 * v.sin(), 120.0 + 90.0 * u.cos()];
        cloud.colours.push(colour.map(code));
    }
    cloud
}

/// A cloud of so many points on the ground with noise, in centimetres far from the origin: with
/// intensities and classes, without colours.
#[must_use]
pub fn noisy_plane(points: u32) -> SourceCloud {
    let mut any = scattered(2);
    let mut cloud = SourceCloud {
        name: "plane".to_owned(),
        placements: vec![DAffine3::IDENTITY],
        scale: [0.01; 3],
        offset: [1e7, 0.0, -5e6],
        ..SourceCloud::default()
    };
    for _ in 0..points {
        let [x, z] = [10_000.0 * any(), 10_000.0 * any()];
        let height = 300.0 * (x / 900.0).sin() + 10.0 * any();
        cloud.places.push([x, height, z].map(|it| it as i32));
        cloud.intensities.push((1000.0 * any()) as u16);
        cloud.classes.push(if height > 0.0 { 2 } else { 5 });
    }
    cloud
}
