//! Do panels show what an eye with astigmatism would see?

use crate::common::difference;
use crate::common::panels::*;
use foveal_core::units::Radians;
use foveal_core::view::axes::Axes;
use foveal_core::view::panel::distortion::Distortion;
use foveal_core::view::panel::eye_blur::EyeBlur;
use foveal_core::view::panel::lens::Bulge;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::rig::{Panel, Scanout};
use foveal_render::twin::{self, TwinSource};
use foveal_render::warp::WarpFilter;
use foveal_render::{Gpu, RgbaImage};
use glam::DVec3;

/// Those that take samples along lines.
const BLURRING: [WarpFilter; 3] = [
    WarpFilter::Anisotropic,
    WarpFilter::Feline,
    WarpFilter::Auto,
];

#[test]
fn what_an_eye_blurs_is_drawn_as_by_the_twin_before_every_source() {
    let gpu = Gpu::open_blocking().unwrap();
    let picture = wavy([300, 200]);
    let mut panels = three([72, 54]);
    panels[0].scanout = Scanout::Rot90;
    panels[1].distortion = Distortion::Bulge(Bulge { height: 0.15 });
    let eye = EyeBlur::new(-6.0, 30.0, 6.0);
    let beside = seed_plane().seen_from(DVec3::X * 0.0315, 1.0);
    let places = [
        seed_plane(),
        beside,
        curved(SourceProjection::Cylinder),
        curved(SourceProjection::Equirect),
        curved(SourceProjection::Fisheye),
    ];
    for placement in places {
        let plan = blurred_plan_of(&panels, &placement, picture.size, &eye);
        let source = TwinSource::new(&picture, true);
        for filter in BLURRING {
            let style = style(filter);
            let drawn = on_gpu(&gpu, &picture, &plan, &style);
            let (worst, off) = difference(&drawn, &twin::warp(&source, &plan, &style));
            println!(
                "{:?} {filter:?}: worst {worst}, beyond 1: {off:.5}",
                placement.projection
            );
            assert!(worst <= 3 && off <= 0.01, "{placement:?} {filter:?}");
        }
    }
}

#[test]
fn an_eye_without_blur_changes_no_byte_and_half_a_turn_or_the_other_sign_of_one_with() {
    let gpu = Gpu::open_blocking().unwrap();
    let picture = wavy([320, 240]);
    let panels = three([80, 60]);
    let of = |cylinder: f64, axis: f64, filter: WarpFilter| {
        let eye = EyeBlur::new(cylinder, axis, 4.0);
        let plan = blurred_plan_of(&panels, &seed_plane(), picture.size, &eye);
        on_gpu(&gpu, &picture, &plan, &style(filter))
    };
    let plain = plan_of(&panels, &seed_plane(), picture.size);
    for filter in WarpFilter::ALL {
        let expected = on_gpu(&gpu, &picture, &plain, &style(filter));
        assert_eq!(of(0.0, 45.0, filter), expected, "{filter:?}");
    }
    for filter in BLURRING {
        let one = of(-4.0, 20.0, filter);
        assert_eq!(one, of(-4.0, 200.0, filter), "{filter:?}");
        assert_eq!(one, of(4.0, 20.0, filter), "{filter:?}");
        assert_ne!(one, of(-4.0, 110.0, filter), "{filter:?}");
    }
}

/// Visual angles, right and down as the eye sees them that is turned to the middle of a picture of
/// light by Listing's law: variances and covariance of that light.
fn moments(panel: &Panel, drawn: &RgbaImage) -> [f64; 3] {
    let linear = |code: u8| match f64::from(code) / 255.0 {
        code if code <= 0.04045 => code / 12.92,
        code => ((code + 0.055) / 1.055).powf(2.4),
    };
    let [w, h] = panel.view.size;
    let pixels = (0..h).flat_map(|y| (0..w).map(move |x| [x, y]));
    let lit: Vec<(f64, DVec3)> = pixels
        .map(|at| {
            let ray = panel.view.ray(at.map(|k| f64::from(k) + 0.5));
            (linear(drawn.pixel(at)[1]), ray.normalize())
        })
        .collect();
    let middle = lit
        .iter()
        .map(|(light, ray)| *ray * *light)
        .sum::<DVec3>()
        .normalize();
    let turn = glam::DQuat::from_rotation_arc(DVec3::NEG_Z, middle);
    let (right, down) = (turn * DVec3::X, turn * DVec3::NEG_Y);
    let sum: f64 = lit.iter().map(|it| it.0).sum();
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        let each = lit
            .iter()
            .map(|(light, ray)| light * of(ray.dot(right), ray.dot(down)));
        each.sum::<f64>() / sum
    };
    let (x, y) = (mean(&|x, _| x), mean(&|_, y| y));
    [
        mean(&|a, _| (a - x) * (a - x)),
        mean(&|_, b| (b - y) * (b - y)),
        mean(&|a, b| (a - x) * (b - y)),
    ]
}

#[test]
fn a_point_becomes_a_line_across_the_axis_of_the_second_moment_of_a_disc_pressed_flat() {
    // Ahead, and far to the side on a source whose own axes are turned another way.
    let ahead = (
        panel("ahead", [0.0; 3], [0.3, 0.225], [200, 150]),
        Placement::new(SourceProjection::Plane, Axes::FRONT, [0.2, 0.2, 0.15, 0.15]),
    );
    let turned = panel("aside", [10.0, -25.0, 48.0], [0.3, 0.225], [200, 150]);
    let [yaw, pitch, roll] = turned.view.axes.yaw_pitch_roll();
    let axes = Axes::from_yaw_pitch_roll(
        Radians(yaw.0 + 0.1),
        Radians(pitch.0 - 0.05),
        Radians(roll.0 + 0.4),
    );
    let window = [0.4, 0.4, 0.3, 0.3];
    let aside = (
        turned,
        Placement::new(SourceProjection::Plane, axes, window),
    );
    for (panel, placement) in [ahead, aside] {
        let size = [1000, 750];
        // A dot where the middle of the panel looks.
        let ray = panel.view.ray([100.0, 75.0]);
        let at = placement.source_from_ray(ray, size).unwrap();
        let dot = |x: f64, y: f64| (x + 0.5 - at[0]).hypot(y + 0.5 - at[1]) < 2.5;
        let picture = painted(size, |x, y| [if dot(x, y) { 255.0 } else { 0.0 }; 3]);
        for axis in [0.0, 30.0, 90.0, 135.0] {
            let of = |filter: Option<WarpFilter>, cylinder: f64| {
                let eye = EyeBlur::new(cylinder, axis, 4.0);
                let plan = blurred_plan_of(std::slice::from_ref(&panel), &placement, size, &eye);
                let drawn = match filter {
                    Some(filter) => {
                        twin::warp(&TwinSource::new(&picture, true), &plan, &style(filter))
                    }
                    None => twin::warp_by_ewa(&TwinSource::new(&picture, false), &plan),
                };
                moments(&panel, &drawn)
            };
            // 4 dioptres and 4 mm are a disc of 16 mrad: a deviation of 4 mrad.
            let variance = 0.004_f64.powi(2);
            let turn = axis.to_radians();
            let across = [-turn.sin(), turn.cos()];
            let expected = [
                across[0] * across[0],
                across[1] * across[1],
                across[0] * across[1],
            ];
            // Feline's samples end before its ellipse does.
            for (filter, most) in [
                (None, 0.1),
                (Some(WarpFilter::Anisotropic), 0.1),
                (Some(WarpFilter::Auto), 0.1),
                (Some(WarpFilter::Feline), 0.2),
            ] {
                let (sharp, wide) = (of(filter, 0.0), of(filter, -4.0));
                let grown = [0, 1, 2].map(|k| (wide[k] - sharp[k]) / variance);
                println!(
                    "{} {axis} {filter:?}: {grown:.3?} for {expected:.3?}",
                    panel.id
                );
                for k in 0..3 {
                    assert!(
                        (grown[k] - expected[k]).abs() < most,
                        "{filter:?} {grown:?}"
                    );
                }
            }
        }
    }
}
