//! What does a cube look like as one equirectangular picture?

use super::kernel::{Kernel, Taps};
use super::padding::PaddedCube;
use crate::parallel::in_parallel;
use foveal_core::units::Radians;
use foveal_core::view::axes::direction_from_yaw_pitch;
use foveal_core::view::picture::{Picture, plane_size};
use foveal_core::view::surface::Surface;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Rows in one part of the work.
const ROWS: usize = 16;

/// The whole sphere of `cube` at `size` pixels, with chroma sited between luma samples; the same
/// for any number of threads `jobs`.
///
/// The filter is that of [`super::CubeSampler`] and reads across the edges of the cube.
///
/// # Panics
/// When the faces are not six equal squares with an even side.
#[must_use]
pub fn equirect_from_cube(cube: &[Picture; 6], size: [u32; 2], jobs: usize) -> Picture {
    let side = cube[0].width;
    assert!(
        side > 0 && side.is_multiple_of(2),
        "a face of {side} pixels"
    );
    for face in cube {
        assert_eq!(
            [face.width, face.height],
            [side; 2],
            "faces of different size"
        );
        assert!(face.is_consistent(), "a face lacks samples");
    }
    let kernel = Kernel::new();
    let planes = [0, 1, 2].map(|p| {
        let size = plane_size(size[0], size[1], p).map(|n| n as usize);
        unfold_plane(cube, p, size, &kernel, jobs)
    });
    Picture {
        width: size[0],
        height: size[1],
        planes,
    }
}

fn unfold_plane(
    cube: &[Picture; 6],
    p: usize,
    [width, height]: [usize; 2],
    kernel: &Kernel,
    jobs: usize,
) -> Vec<u8> {
    let face = cube[0].plane_size(p)[0] as usize;
    let steps = [TAU / width as f64, PI / height as f64];
    // At a corner of the cube a radian spans 1.5 faces.
    let margin = PaddedCube::margin_for((1.5 * face as f64 * steps[0].max(steps[1])).max(1.0));
    let planes = [0, 1, 2, 3, 4, 5].map(|f: usize| cube[f].planes[p].as_slice());
    let padded = PaddedCube::new(planes, face, margin, kernel);
    let surface = Surface::cube(face as u32);
    let parts = in_parallel(jobs, height.div_ceil(ROWS), |part| {
        let mut taps = [Taps::default(), Taps::default()];
        let rows = part * ROWS..((part + 1) * ROWS).min(height);
        let mut out = Vec::with_capacity(rows.len() * width);
        for y in rows {
            let pitch = PI / 2.0 - (y as f64 + 0.5) * steps[1];
            for x in 0..width {
                let yaw = (x as f64 + 0.5) * steps[0] - PI;
                let sample = locate(&surface, [yaw, pitch], steps);
                out.push(sample.map_or(0, |(face, place, stretch)| {
                    padded.at(kernel, face, place, stretch, &mut taps)
                }));
            }
        }
        out
    });
    parts.concat()
}

/// Face, place in samples, and face samples a step of the picture along both axes of the face.
fn locate(
    surface: &Surface,
    [yaw, pitch]: [f64; 2],
    steps: [f64; 2],
) -> Option<(u32, [f64; 2], [f64; 2])> {
    let direction = direction_from_yaw_pitch(Radians(yaw), Radians(pitch));
    let (face, place) = surface.locate(direction)?;
    let axes = surface.axes(face);
    let depth = direction.dot(axes.forward);
    let east = DVec3::new(-direction.z, 0.0, direction.x) * steps[0];
    let north = direction_from_yaw_pitch(Radians(yaw), Radians(pitch + PI / 2.0)) * steps[1];
    let stretch = [axes.right, axes.down].map(|axis| {
        let tangent = direction.dot(axis) / depth;
        let change = |step: DVec3| (step.dot(axis) - tangent * step.dot(axes.forward)) / depth;
        let length = (change(east) * change(east) + change(north) * change(north)).sqrt();
        (length * f64::from(surface.size[0]) / 2.0).max(1.0)
    });
    Some((face, place, stretch))
}
