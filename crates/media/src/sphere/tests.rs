//! Does the sphere survive the way to the cube and back?

use super::*;
use foveal_core::units::Radians;
use foveal_core::view::axes::direction_from_yaw_pitch;
use foveal_core::view::picture::plane_size;
use foveal_core::view::surface::Surface;
use glam::DVec3;
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
fn cube_of(face: u32, mapping: Mapping, function: impl Fn(DVec3, usize) -> f64) -> [Picture; 6] {
    [0, 1, 2, 3, 4, 5].map(|f| {
        let mut picture = Picture::filled(face, face, [0; 3]);
        for p in 0..3 {
            let [w, _] = picture.plane_size(p);
            let surface = Surface::cube(w).mapped(mapping);
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

const MAPPINGS: [Mapping; 2] = [Mapping::Gnomonic, Mapping::EquiAngular];

const AXES: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [0.3, 0.1, -1.0], [1.0, -0.9, 0.8]];

#[test]
fn the_faces_show_what_the_sphere_shows() {
    let [w, face] = [1024, 256];
    for (axis, mapping) in AXES
        .into_iter()
        .flat_map(|axis| MAPPINGS.map(|m| (axis, m)))
    {
        let plate = zone_plate(DVec3::from_array(axis), 0.4, face);
        for siting in [Siting::Left, Siting::Centre] {
            let equirect = equirect_of([w, w / 2], siting, plate);
            let left = siting == Siting::Left;
            let sampler = CubeSampler::new([w, w / 2], face, Coverage::Full, left).mapped(mapping);
            let cube = sampler.cube_from_equirect(&equirect, 2);
            let truth = cube_of(face, mapping, plate);
            for (f, (face, truth)) in cube.iter().zip(&truth).enumerate() {
                for p in 0..3 {
                    let quality = psnr(&face.planes[p], &truth.planes[p]);
                    let pairs = face.planes[p].iter().zip(&truth.planes[p]);
                    let largest = pairs.map(|(a, b)| a.abs_diff(*b)).max();
                    println!("axis {axis:?} face {f} plane {p}: {quality:.1} dB, {largest:?}");
                    // No sample is far off, not even around the poles, where equi-angular faces
                    // are as dense as the source's rows.
                    let most = if mapping == Mapping::Gnomonic { 8 } else { 16 };
                    assert!(quality > 48.0 && largest <= Some(most));
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

#[test]
fn the_fast_way_shows_what_the_exact_one_does() {
    for (w, face, mapping) in [
        (1024, 256, Mapping::Gnomonic),
        (1024, 256, Mapping::EquiAngular),
        (960, 240, Mapping::EquiAngular),
        (512, 128, Mapping::Gnomonic),
    ] {
        for (coverage, given) in [(Coverage::Full, w), (Coverage::FrontHalf, w / 2)] {
            for siting in [Siting::Centre, Siting::Left] {
                let left = matches!(siting, Siting::Left);
                for axis in AXES {
                    let plate = zone_plate(DVec3::from_array(axis), 0.2, face);
                    let whole = equirect_of([w, w / 2], siting, plate);
                    let source = whole.crop([(w - given) / 2, 0], [given, w / 2]);
                    let size = [given, w / 2];
                    let sampler = || CubeSampler::new(size, face, coverage, left).mapped(mapping);
                    let fast = sampler().fast();
                    assert!(fast.fast.is_some(), "{w}");
                    let fast = fast.cube_from_equirect(&source, 2);
                    let exact = sampler().cube_from_equirect(&source, 2);
                    for (f, (fast, exact)) in fast.iter().zip(&exact).enumerate() {
                        for p in 0..3 {
                            let reached = psnr(&fast.planes[p], &exact.planes[p]);
                            let pairs = fast.planes[p].iter().zip(&exact.planes[p]);
                            let most = pairs.map(|(a, b)| a.abs_diff(*b)).max();
                            let what = format!("{w} {coverage:?} {axis:?} face {f} plane {p}");
                            assert!(reached > 36.0, "{what}: {reached:.1} dB, {most:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_fast_way_keeps_constants_and_does_not_depend_on_threads() {
    let sizes = [[512, 256], [1000, 500], [130, 65], [64, 32]];
    for (size, mapping) in sizes
        .into_iter()
        .flat_map(|size| MAPPINGS.map(|m| (size, m)))
    {
        let sampler = CubeSampler::new(size, 128, Coverage::Full, true)
            .mapped(mapping)
            .fast();
        for face in sampler.cube_from_equirect(&Picture::filled(size[0], size[1], [77, 99, 201]), 3)
        {
            assert_eq!(face, Picture::filled(128, 128, [77, 99, 201]), "{size:?}");
        }
    }
    let plate = zone_plate(DVec3::new(0.2, 1.0, 0.1), 0.4, 128);
    let equirect = equirect_of([512, 256], Siting::Left, plate);
    let sampler = CubeSampler::new([512, 256], 128, Coverage::Full, true).fast();
    let one = sampler.cube_from_equirect(&equirect, 1);
    assert_eq!(one, sampler.cube_from_equirect(&equirect, 5));
}

#[test]
fn a_constant_stays_constant_at_any_size() {
    for size in [[64, 32], [100, 50], [66, 34], [1000, 333], [2, 2], [30, 90]] {
        for (face, coverage) in [
            (16, Coverage::Full),
            (2, Coverage::Full),
            (90, Coverage::Full),
        ] {
            let picture = Picture::filled(size[0], size[1], [77, 99, 201]);
            let sampler = CubeSampler::new(size, face, coverage, true);
            for face_picture in sampler.cube_from_equirect(&picture, 2) {
                assert_eq!(
                    face_picture,
                    Picture::filled(face, face, [77, 99, 201]),
                    "{size:?}"
                );
            }
        }
    }
    let cube = [0; 6].map(|_: u8| Picture::filled(32, 32, [40, 50, 60]));
    assert_eq!(
        equirect_from_cube(&cube, [100, 50], 2),
        Picture::filled(100, 50, [40, 50, 60])
    );
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let plate = zone_plate(DVec3::new(0.2, 1.0, 0.1), 0.4, 48);
    let equirect = equirect_of([200, 100], Siting::Left, plate);
    let sampler = CubeSampler::new([200, 100], 50, Coverage::Full, true);
    let one = sampler.cube_from_equirect(&equirect, 1);
    assert_eq!(one, sampler.cube_from_equirect(&equirect, 5));
    let back = equirect_from_cube(&one, [200, 100], 1);
    assert_eq!(back, equirect_from_cube(&one, [200, 100], 3));
}

/// The largest difference between samples that touch across an edge of the cube, over plane `p`.
fn largest_step_across_edges(cube: &[Picture; 6], mapping: Mapping, p: usize) -> f64 {
    let [n, _] = cube[0].plane_size(p);
    let surface = Surface::cube(n).mapped(mapping);
    let at = |face: u32, [x, y]: [f64; 2]| {
        let [x, y] = [x, y].map(|k| (k as u32).min(n - 1));
        f64::from(cube[face as usize].planes[p][(y * n + x) as usize])
    };
    let mut largest = 0.0f64;
    for face in 0..6 {
        for k in 0..n {
            let (along, far) = (f64::from(k) + 0.5, f64::from(n));
            let edges = [[along, 0.0], [along, far], [0.0, along], [far, along]];
            for edge in edges {
                let outward = edge.map(|k| match k {
                    0.0 => -0.4,
                    k if k == far => far + 0.4,
                    k => k,
                });
                let (other, place) = surface.locate(surface.direction(face, outward)).unwrap();
                assert_ne!(other, face);
                largest = largest.max((at(face, edge) - at(other, place)).abs());
            }
        }
    }
    largest
}

#[test]
fn nothing_shows_at_the_edges_of_the_cube() {
    let smooth = |d: DVec3, _: usize| 128.0 + 40.0 * (d.x * 2.0 + d.y).sin() - 50.0 * d.z * d.y;
    let equirect = equirect_of([512, 256], Siting::Centre, smooth);
    for mapping in MAPPINGS {
        let sampler = CubeSampler::new([512, 256], 128, Coverage::Full, false).mapped(mapping);
        let cube = sampler.cube_from_equirect(&equirect, 2);
        // At most 110 code values a radian over at most two samples of 1/64 radian, and rounding.
        assert!(largest_step_across_edges(&cube, mapping, 0) <= 5.0);
        assert!(largest_step_across_edges(&cube, mapping, 1) <= 9.0);
    }
}

#[test]
fn hemispheres_keep_their_side_of_every_edge() {
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        let half = |d: DVec3, _: usize| if d.dot(axis) > 0.0 { 200.0 } else { 50.0 };
        let equirect = equirect_of([512, 256], Siting::Left, half);
        let sampler = CubeSampler::new([512, 256], 128, Coverage::Full, true);
        let cube = sampler.cube_from_equirect(&equirect, 2);
        for (f, face) in cube.iter().enumerate() {
            for p in 0..3 {
                let [n, _] = face.plane_size(p);
                let surface = Surface::cube(n);
                for (at, &sample) in face.planes[p].iter().enumerate() {
                    let place = [at as u32 % n, at as u32 / n].map(|k| f64::from(k) + 0.5);
                    let side = surface.direction(f as u32, place).dot(axis);
                    // Beyond the kernel nothing of the step is left.
                    if side.abs() > 7.0 * 2.0 / f64::from(n) {
                        let expected = if side > 0.0 { 200 } else { 50 };
                        assert!(sample.abs_diff(expected) <= 1, "{f} {p} {place:?} {sample}");
                    }
                }
            }
        }
    }
}

#[test]
fn half_a_sphere_fills_the_front_and_leaves_the_back_black() {
    let smooth = |d: DVec3, _: usize| 128.0 + 60.0 * d.x + 30.0 * d.y;
    let whole = equirect_of([512, 256], Siting::Centre, smooth);
    let half = whole.crop([128, 0], [256, 256]);
    let from_whole = CubeSampler::new([512, 256], 128, Coverage::Full, false);
    let from_half = CubeSampler::new([256, 256], 128, Coverage::FrontHalf, false);
    let whole = from_whole.cube_from_equirect(&whole, 2);
    let half = from_half.cube_from_equirect(&half, 2);
    assert_eq!(half[0], whole[0]);
    assert_eq!(half[2], Picture::filled(128, 128, [16, 128, 128]));
    for f in [1, 3, 4, 5] {
        let mut black = 0;
        for (half, whole) in half[f].planes[0].iter().zip(&whole[f].planes[0]) {
            black += u32::from(*half == 16);
            assert!(
                *half == 16 || half.abs_diff(*whole) <= 2,
                "{f} {half} {whole}"
            );
        }
        assert_eq!(black, 128 * 64);
    }
}

/// `cargo test --release -p foveal-media conversion_speed -- --ignored --nocapture`
#[test]
#[ignore = "a measurement"]
fn conversion_speed() {
    for w in [2048, 4096, 8192] {
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
        let fast = CubeSampler::new([w, w / 2], face, Coverage::Full, true).fast();
        let start = std::time::Instant::now();
        std::hint::black_box(fast.cube_from_equirect(&equirect, 1));
        println!("{w}: fast, 1 job {:.3} s", start.elapsed().as_secs_f64());
        let cube = sampler.cube_from_equirect(&equirect, 2);
        let start = std::time::Instant::now();
        std::hint::black_box(equirect_from_cube(&cube, [w, w / 2], 2));
        println!("{w}: back {:.2} s", start.elapsed().as_secs_f64());
    }
}
