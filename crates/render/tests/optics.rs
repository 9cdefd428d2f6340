//! Does a panel's own picture reach its pixels as its optics have it?

use crate::common::difference;
use crate::common::panels::*;
use foveal_core::view::axes::Axes;
use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::distortion::{Distortion, GREEN};
use foveal_core::view::panel::lens::{Bulge, RadialPolynomial};
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::residual_grid::ResidualGrid;
use foveal_core::view::panel::rig::{Panel, Scanout};
use foveal_render::twin::{self, TwinSource};
use foveal_render::warp::{PanelOptics, WarpFilter, WarpStyle};
use foveal_render::{DrawDevice, Gpu, RgbaImage};
use std::sync::Arc;

/// Waves along directions: what a panel shows does not depend on which panel it is.
fn code_along(ray: glam::DVec3) -> [f64; 3] {
    let [x, y] = [ray.x, ray.y].map(|k| k / ray.length());
    let wave = |phase: f64| 128.0 + 90.0 * (phase).sin();
    [wave(9.0 * x), wave(7.0 * y), wave(8.0 * (x + y))]
}

/// The flat picture of all that a panel reaches.
fn flat_of(panel: &Panel) -> RgbaImage {
    let reach = panel.reach();
    painted(reach.size, |x, y| code_along(reach.ray([x + 0.5, y + 0.5])))
}

fn lens(panel: Panel) -> Panel {
    let channel = |k: f64| RadialPolynomial {
        centre: [0.01, -0.02],
        coefficients: vec![1.0, 0.0, k],
    };
    let distortion = Distortion::Polynomial(Box::new([channel(0.2), channel(0.24), channel(0.3)]));
    Panel {
        distortion,
        ..panel
    }
}

/// Three panels: one bulges and is sent on its side, colours part on one, one was measured; all
/// fade and are dimmed.
fn bent() -> Vec<Panel> {
    let size = [96, 72];
    let mut panels = three(size);
    panels[0].scanout = Scanout::Rot90;
    panels[0].distortion = Distortion::Bulge(Bulge { height: 0.15 });
    panels[1] = lens(panels[1].clone());
    panels[1].scanout = Scanout::FlipX;
    let measured = ResidualGrid::over(size, [9, 7], |[x, y]| {
        [4.0 * (y / 20.0).sin(), 3.0 * (x / 30.0).cos()]
    });
    panels[2].distortion = Distortion::Grid([(); 3].map(|()| Arc::new(measured.clone())));
    for panel in &mut panels {
        panel.blend = 0.2;
        panel.gain = [0.9, 1.0, 0.7];
        panel.black = 0.02;
    }
    let fade = |k: u32| 65_535 - (k % 30_000) as u16;
    panels[1].alpha = Some(AlphaMap::new(size, (0..size[0] * size[1]).map(fade).collect()).into());
    panels
}

#[test]
fn a_gpu_bends_fades_and_dims_as_its_twin_does() {
    let gpu = Gpu::open_blocking().unwrap();
    let panels = bent();
    let mut optics = PanelOptics::new(&panels);
    let device = DrawDevice::Gpu(gpu);
    for (at, panel) in panels.iter().enumerate() {
        let flat = flat_of(panel);
        let drawn = optics.image(&device, at, flat.clone()).unwrap();
        assert_eq!(drawn.size, panel.sent_size());
        let expected = optics.image(&DrawDevice::Twin, at, flat).unwrap();
        let (worst, off) = difference(&drawn, &expected);
        println!("{}: worst {worst}, beyond 1: {off:.5}", panel.id);
        assert!(worst <= 3 && off <= 0.01, "{}: {worst}, {off}", panel.id);
    }
}

#[test]
fn a_bent_pixel_shows_what_lies_along_its_ray() {
    for mut panel in bent() {
        panel.scanout = Scanout::Normal;
        (panel.blend, panel.black, panel.gain) = (0.0, 0.0, [1.0; 3]);
        panel.alpha = None;
        let mut optics = PanelOptics::new(std::slice::from_ref(&panel));
        assert!(optics.changes(0));
        let seen = optics.image(&DrawDevice::Twin, 0, flat_of(&panel)).unwrap();
        let channels = match panel.distortion.parts_colours() {
            true => [0, 1, 2],
            false => [GREEN; 3],
        };
        for k in 0..400_u32 {
            let at = [k * 37 % panel.view.size[0], k * 61 % panel.view.size[1]];
            for (channel, by) in channels.into_iter().enumerate() {
                let ray = panel.ray_at(at.map(|k| f64::from(k) + 0.5), by).unwrap();
                let expected = code_along(ray.ray)[channel];
                let off = (f64::from(seen.pixel(at)[channel]) - expected).abs();
                assert!(off <= 3.0, "{} {at:?}: {off}", panel.id);
            }
        }
    }
}

#[test]
fn what_nothing_bends_or_dims_is_left_alone_and_what_fades_keeps_its_places() {
    let mut panels = three([80, 60]);
    let mut optics = PanelOptics::new(&panels);
    let flat = flat_of(&panels[1]);
    assert!(!optics.changes(1));
    let same = optics.image(&DrawDevice::Twin, 1, flat.clone()).unwrap();
    assert!(same == flat);
    // A panel that fades where no other overlaps it has nothing to share.
    panels[1].blend = 0.1;
    let mut optics = PanelOptics::new(&panels);
    assert!(optics.changes(1) && !optics.changes(0));
    let same = optics.image(&DrawDevice::Twin, 1, flat.clone()).unwrap();
    assert_eq!(difference(&same, &flat).0, 0);
}

#[test]
fn panels_that_fade_one_by_one_share_light_as_those_of_one_source_do() {
    let gpu = Gpu::open_blocking().unwrap();
    let mut panels = three([80, 60]);
    for panel in &mut panels {
        (panel.blend, panel.black) = (0.15, 0.01);
    }
    let white = painted([64, 64], |_, _| [255.0; 3]);
    let window = [2.0, 2.0, 1.5, 1.5];
    let wide = Placement::new(SourceProjection::Equirect, Axes::FRONT, window);
    let style = WarpStyle {
        filter: WarpFilter::Bilinear,
        ..WarpStyle::default()
    };
    let plan = plan_of(&panels, &wide, white.size);
    let together = twin::warp(&TwinSource::new(&white, false), &plan, &style);
    let mut optics = PanelOptics::new(&panels);
    let flat = painted([80, 60], |_, _| [255.0; 3]);
    let device = DrawDevice::Gpu(gpu);
    let mut dimmed = 0;
    for (at, record) in plan.panels.iter().enumerate() {
        let own = optics.image(&device, at, flat.clone()).unwrap();
        for y in 0..60 {
            for x in 0..80 {
                let shared = together.pixel([record.origin[0] + x, record.origin[1] + y])[0];
                let alone = own.pixel([x, y])[0];
                assert!(
                    alone.abs_diff(shared) <= 1,
                    "{at} {x},{y}: {alone} {shared}"
                );
                dimmed += u32::from(alone < 250);
            }
        }
    }
    assert!(dimmed > 1000, "{dimmed}");
}

#[test]
fn a_smaller_display_of_the_same_optics_looks_along_the_same_rays() {
    for panel in bent() {
        let half = panel.resized(panel.view.size.map(|side| side / 2));
        assert_eq!(half.alpha.is_some(), panel.alpha.is_some());
        for place in [[3.0, 5.0], [20.0, 30.0], [47.0, 1.0]] {
            let own = panel.ray_at(place.map(|k| 2.0 * k), GREEN).unwrap().ray;
            let small = half.ray_at(place, GREEN).unwrap().ray;
            let apart = own.normalize().distance(small.normalize());
            assert!(apart < 1e-6, "{} {place:?}: {apart}", panel.id);
        }
    }
}

#[test]
fn a_picture_that_is_not_the_flat_one_of_the_panel_is_refused() {
    let panels = bent();
    let mut optics = PanelOptics::new(&panels);
    let wrong = optics.image(&DrawDevice::Twin, 0, RgbaImage::black([3, 4]));
    let told = wrong.unwrap_err().to_string();
    assert!(told.contains("flat picture of a panel"), "{told}");
}
