//! Does a view show the source as it is, wherever it looks?

use super::*;
use crate::sphere::Coverage;
use crate::surround::cube_layout::CubeLayout;
use crate::surround::eye_layout::Packing;
use foveal_core::units::Radians;
use foveal_core::view::axes::{Axes, direction_from_yaw_pitch};
use foveal_core::view::eye_view::Field;
use foveal_core::view::picture::Matrix;
use foveal_core::view::surface::CUBE_FACES;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Codes are red, green and blue where chroma is grey.
const PLAIN: Colour = Colour {
    matrix: Matrix::Bt709,
    full_range: true,
    chroma_left: false,
};

fn source(surround: Surround, surface: Surface) -> SourceView {
    SourceView {
        surround,
        part: None,
        eyes: EyeLayout::default(),
        surface,
        colour: PLAIN,
    }
}

/// A grey picture whose luma is a function of the place of a pixel's middle.
fn grey([width, height]: [u32; 2], luma: impl Fn([f64; 2]) -> f64) -> Picture {
    let mut picture = Picture::filled(width, height, [0, 128, 128]);
    for (at, code) in picture.planes[0].iter_mut().enumerate() {
        let place = [at % width as usize, at / width as usize].map(|k| k as f64 + 0.5);
        *code = luma(place).round() as u8;
    }
    picture
}

/// Light all round: waves of about 20 pixels of a turn of 512.
fn world(direction: DVec3) -> f64 {
    let d = direction * 22.0;
    128.0 + 40.0 * (d.x + 0.4 * d.y).sin() + 35.0 * (d.z - d.y).cos() + 30.0 * (1.3 * d.y).sin()
}

fn equirect(size: [u32; 2], turn: f64) -> Picture {
    let [w, h] = size.map(f64::from);
    grey(size, |[x, y]| {
        let yaw = Radians((x - w / 2.0) / turn * TAU);
        world(direction_from_yaw_pitch(yaw, Radians((0.5 - y / h) * PI)))
    })
}

fn looking([yaw, pitch]: [f64; 2], across: f64, size: [u32; 2]) -> EyeView {
    let degrees = Radians::from_degrees;
    EyeView {
        position: Default::default(),
        axes: Axes::from_yaw_pitch_roll(degrees(yaw), degrees(pitch), degrees(20.0)),
        field: Field::across(degrees(across), size),
        size,
        eye: Eye::Left,
    }
}

/// The largest distance of what a view shows from the world that it looks at.
fn worst(source: &SourceView, picture: &Picture, view: &EyeView) -> f64 {
    let seen = source.of(picture).seen(view, 2);
    let pixels = seen.chunks_exact(3).enumerate().map(|(at, rgb)| {
        let width = view.size[0] as usize;
        let place = [at % width, at / width].map(|k| k as f64 + 0.5);
        (f64::from(rgb[0]) - world(view.ray(place).normalize())).abs()
    });
    pixels.fold(0.0, f64::max)
}

#[test]
fn a_sphere_is_seen_as_the_world_that_it_samples_over_its_seam_and_its_poles() {
    let sphere = Surround::Equirect(Coverage::Full);
    let source = source(sphere, Surface::cube(128));
    let picture = equirect([512, 256], 512.0);
    for (towards, most) in [
        ([0.0, 0.0], 3.0),
        ([180.0, 10.0], 3.0),
        ([-175.0, -30.0], 3.0),
        ([40.0, 90.0], 8.0),
        ([0.0, -80.0], 8.0),
    ] {
        for across in [40.0, 80.0] {
            let found = worst(&source, &picture, &looking(towards, across, [96, 80]));
            assert!(found <= most, "{towards:?}, {across}: {found}");
        }
    }
}

#[test]
fn half_a_sphere_is_black_behind_and_the_world_before_the_eye() {
    let half = Surround::Equirect(Coverage::FrontHalf);
    let source = source(half, Surface::cube(128));
    let picture = equirect([256, 256], 512.0);
    let found = worst(&source, &picture, &looking([20.0, 10.0], 60.0, [64, 48]));
    assert!(found <= 3.0, "{found}");
    let behind = looking([180.0, 0.0], 60.0, [64, 48]);
    assert!(source.of(&picture).seen(&behind, 1).iter().all(|c| *c == 0));
}

#[test]
fn a_cube_is_seen_as_the_world_over_its_edges_and_corners() {
    let face = 128;
    let surface = Surface::cube(face);
    let size = [3 * face, 2 * face];
    let layout = CubeLayout::of_size(size).unwrap();
    let source = source(Surround::Cube(layout), surface);
    // The order of faces in a picture of 3x2: right, left, top; bottom, front, back.
    let order = [1, 3, 4, 5, 0, 2];
    let side = f64::from(face);
    let picture = grey(size, |[x, y]| {
        let face = order[(x / side) as usize + 3 * (y / side) as usize];
        world(surface.direction(face, [x % side, y % side]))
    });
    assert_eq!(CUBE_FACES.len(), order.len());
    for towards in [[0.0, 0.0], [45.0, 0.0], [45.0, 35.0], [130.0, -40.0]] {
        let found = worst(&source, &picture, &looking(towards, 50.0, [64, 48]));
        assert!(found <= 6.0, "{towards:?}: {found}");
    }
}

/// Luma that no filter leaves as it is.
fn rough([x, y]: [f64; 2]) -> f64 {
    (x * 37.0 + y * 91.0 + x * y * 13.0)
        .rem_euclid(256.0)
        .floor()
        .min(255.0)
}

#[test]
fn a_flat_picture_at_one_pixel_a_pixel_is_itself_whole_or_in_part() {
    let size = [60, 40];
    let surface = Surface::flat(size, Screen::default());
    let source = source(Surround::Flat, surface);
    let picture = grey(size, rough);
    let seen = source
        .of(&picture)
        .seen(&EyeView::filling(&surface, size), 1);
    let lumas: Vec<u8> = seen.chunks_exact(3).map(|rgb| rgb[1]).collect();
    assert_eq!(lumas, picture.planes[0]);
    let part = EyeView::of_part(&surface, [13, 7], [20, 16]);
    let seen = source.of(&picture).seen(&part, 1);
    let lumas: Vec<u8> = seen.chunks_exact(3).map(|rgb| rgb[1]).collect();
    let rows = picture.planes[0].chunks_exact(60).skip(7).take(16);
    let wanted: Vec<u8> = rows.flat_map(|row| row[13..33].to_vec()).collect();
    assert_eq!(lumas, wanted);
}

#[test]
fn what_a_view_is_too_coarse_for_becomes_its_mean() {
    let size = [240, 160];
    let surface = Surface::flat(size, Screen::default());
    let source = source(Surround::Flat, surface);
    let checker = |[x, y]: [f64; 2]| match (x.floor() + y.floor()) % 2.0 == 0.0 {
        true => 40.0,
        false => 200.0,
    };
    let seen = source
        .of(&grey(size, checker))
        .seen(&EyeView::filling(&surface, [60, 40]), 1);
    assert!(seen.iter().all(|code| code.abs_diff(120) <= 8), "{seen:?}");
}

#[test]
fn beside_the_picture_is_nothing_and_each_eye_sees_its_own() {
    let surface = Surface::flat([32, 32], Screen::default());
    let both = SourceView {
        eyes: EyeLayout {
            packing: Packing::SideBySide,
            right_first: false,
        },
        ..source(Surround::Flat, surface)
    };
    let picture = grey([64, 32], |[x, _]| if x < 32.0 { 50.0 } else { 90.0 });
    let mut view = EyeView::filling(&surface, [48, 48]);
    view.field = Field::symmetric(surface.tangents.map(|t| t * 2.0));
    for (eye, luma) in [(Eye::Left, 50), (Eye::Right, 90)] {
        let seen = both.of(&picture).seen(&EyeView { eye, ..view }, 1);
        let at = |x: usize, y: usize| seen[(y * 48 + x) * 3];
        assert_eq!((at(24, 24), at(4, 24), at(24, 44)), (luma, 0, 0));
    }
}

#[test]
fn a_view_is_the_same_for_any_number_of_threads() {
    let source = source(Surround::Equirect(Coverage::Full), Surface::cube(32));
    let picture = grey([128, 64], rough);
    let view = looking([30.0, 60.0], 90.0, [70, 50]);
    let seen = source.of(&picture).seen(&view, 1);
    assert_eq!(seen, source.of(&picture).seen(&view, 5));
}
