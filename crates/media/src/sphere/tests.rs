use super::*;
use foveal_core::asset::picture::plane_size;
use foveal_core::units::Radians;
use foveal_core::view::axes::direction_from_yaw_pitch;
use foveal_core::view::surface::Surface;
use glam::DVec3;
use proptest::prelude::*;
use std::f64::consts::PI;

/// Where the two chroma samples of a pair of luma samples lie.
#[derive(Clone, Copy, PartialEq)]
enum Siting {
    Left,
    Centre,
}

/// A whole sphere that shows `function`, code values of Y, U and V at a direction.
fn equirect_of(
    [w, h]: [u32; 2],
    siting: Siting,
    function: impl Fn(DVec3, usize) -> f64,
) -> Picture {
    let mut picture = Picture::filled(w, h, [0; 3]);
    for p in 0..3 {
        let [w, h] = plane_size(w, h, p);
        let shift = if p > 0 && siting == Siting::Left {
            0.25
        } else {
            0.5
        };
        let shift = if p == 0 { 0.5 } else { shift };
        for y in 0..h {
            let pitch = (0.5 - (f64::from(y) + 0.5) / f64::from(h)) * PI;
            for x in 0..w {
                let yaw = ((f64::from(x) + shift) / f64::from(w) - 0.5) * 2.0 * PI;
                let direction = direction_from_yaw_pitch(Radians(yaw), Radians(pitch));
                let value = function(direction, p);
                picture.planes[p][(y * w + x) as usize] = value.round().clamp(0.0, 255.0) as u8;
            }
        }
    }
    picture
}

/// A cube that shows `function`.
fn cube_of(face: u32, function: impl Fn(DVec3, usize) -> f64) -> [Picture; 6] {
    [0, 1, 2, 3, 4, 5].map(|f| {
        let mut picture = Picture::filled(face, face, [0; 3]);
        for p in 0..3 {
            let [w, _] = picture.plane_size(p);
            let surface = Surface::cube(w);
            for (at, sample) in picture.planes[p].iter_mut().enumerate() {
                let place = [at as u32 % w, at as u32 / w].map(|k| f64::from(k) + 0.5);
                let value = function(surface.direction(f, place), p);
                *sample = value.round().clamp(0.0, 255.0) as u8;
            }
        }
        picture
    })
}

fn psnr(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let square = |(&a, &b): (&u8, &u8)| (f64::from(a) - f64::from(b)).powi(2);
    let sum: f64 = a.iter().zip(b).map(square).sum();
    10.0 * (255.0 * 255.0 * a.len() as f64 / sum.max(1e-9)).log10()
}

/// A plane wave through the ball, seen on the sphere: its local frequency runs from 0 at both ends
/// of `axis` to `peak` cycles per sample of the sparsest place of a cube of `face` samples, and on.
fn zone_plate(axis: DVec3, peak: f64, face: u32) -> impl Fn(DVec3, usize) -> f64 + Copy {
    let axis = axis.normalize();
    move |direction, p| {
        let samples_a_radian = f64::from(face) / 2.0 / if p > 0 { 2.0 } else { 1.0 };
        let phase = direction.dot(axis) * 2.0 * PI * peak * samples_a_radian;
        128.0 + 100.0 * phase.cos()
    }
}

const AXES: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [0.3, 0.1, -1.0], [1.0, -0.9, 0.8]];

#[test]
fn the_faces_show_what_the_sphere_shows() {
    let [w, face] = [1024, 256];
    for axis in AXES {
        let plate = zone_plate(DVec3::from_array(axis), 0.4, face);
        for siting in [Siting::Left, Siting::Centre] {
            let equirect = equirect_of([w, w / 2], siting, plate);
            let left = siting == Siting::Left;
            let sampler = CubeSampler::new([w, w / 2], face, Coverage::Full, left);
            let cube = sampler.cube_from_equirect(&equirect, 2);
            let truth = cube_of(face, plate);
            for (f, (face, truth)) in cube.iter().zip(&truth).enumerate() {
                for p in 0..3 {
                    let quality = psnr(&face.planes[p], &truth.planes[p]);
                    println!("axis {axis:?} face {f} plane {p}: {quality:.1} dB");
                    assert!(quality > 40.0);
                }
            }
        }
    }
}

#[test]
fn a_sphere_survives_the_way_to_the_cube_and_back() {
    let [w, face] = [1024, 256];
    let sampler = CubeSampler::new([w, w / 2], face, Coverage::Full, false);
    for (peak, least) in [(0.2, 46.0), (0.4, 40.0), (0.45, 0.0)] {
        for axis in AXES {
            let plate = zone_plate(DVec3::from_array(axis), peak, face);
            let before = equirect_of([w, w / 2], Siting::Centre, plate);
            let cube = sampler.cube_from_equirect(&before, 2);
            let after = equirect_from_cube(&cube, [w, w / 2], 2);
            for p in 0..3 {
                let quality = psnr(&before.planes[p], &after.planes[p]);
                println!("peak {peak} axis {axis:?} plane {p}: {quality:.1} dB");
                assert!(quality > least, "{quality}");
            }
        }
    }
}

/// `cargo test --release -p foveal-media conversion_speed -- --ignored --nocapture`
#[test]
#[ignore = "a measurement"]
fn conversion_speed() {
    for w in [4096] {
        let face = face_size_for(w, Coverage::Full);
        let equirect = equirect_of([w, w / 2], Siting::Centre, |d, _| 128.0 + 90.0 * d.x);
        let sampler = CubeSampler::new([w, w / 2], face, Coverage::Full, true);
        for jobs in [1, 2] {
            let start = std::time::Instant::now();
            let turns = 3;
            for _ in 0..turns {
                std::hint::black_box(sampler.cube_from_equirect(&equirect, jobs));
            }
            let seconds = start.elapsed().as_secs_f64() / f64::from(turns);
            let rate = f64::from(w * w / 2) / seconds / 1e6;
            println!("{w}: {jobs} jobs {seconds:.3} s, {rate:.1} MPix/s of luma");
        }
        let cube = sampler.cube_from_equirect(&equirect, 2);
        let start = std::time::Instant::now();
        std::hint::black_box(equirect_from_cube(&cube, [w, w / 2], 2));
        println!("{w}: back {:.2} s", start.elapsed().as_secs_f64());
    }
}
