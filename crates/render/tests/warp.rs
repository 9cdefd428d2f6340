//! Are all panels of a rig filled from one source as they should be?

use crate::common::difference;
use crate::common::panels::*;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::Field;
use foveal_core::view::panel::alpha::AlphaMap;
use foveal_core::view::panel::distortion::{Distortion, GREEN};
use foveal_core::view::panel::fit::{PlacementRule, fit};
use foveal_core::view::panel::lens::{Bulge, RadialPolynomial};
use foveal_core::view::panel::pixel_map::PixelMap;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::rig::{Panel, Scanout};
use foveal_core::view::panel::seed::SeedTexel;
use foveal_render::twin::{self, TwinSource};
use foveal_render::warp::{PanelOnSource, SourceTexture, WarpFilter, WarpPlan, WarpStyle, Warper};
use foveal_render::{Gpu, RgbaImage};

/// Within 1 of 255 on 99 % of all channels and nowhere more than 3: a device weighs levels and
/// texels with few bits.
fn assert_as_twin(gpu: &Gpu, picture: &RgbaImage, plan: &WarpPlan, style: &WarpStyle, what: &str) {
    let source = TwinSource::new(picture, style.filter.reads_levels());
    let drawn = on_gpu(gpu, picture, plan, style);
    let expected = twin::warp(&source, plan, style);
    let (worst, off) = difference(&drawn, &expected);
    println!("{what} {style:?}: worst {worst}, beyond 1: {off:.5}");
    assert!(
        worst <= 3 && off <= 0.01,
        "{what} {style:?}: {worst}, {off}"
    );
}

fn colour_lens(panel: Panel) -> Panel {
    let lens = |k: f64| RadialPolynomial {
        centre: [0.01, -0.02],
        coefficients: vec![1.0, 0.0, k],
    };
    Panel {
        distortion: Distortion::Polynomial(Box::new([lens(0.2), lens(0.24), lens(0.3)])),
        ..panel
    }
}

fn projections() -> [Placement; 4] {
    [
        seed_plane(),
        curved(SourceProjection::Cylinder),
        curved(SourceProjection::Equirect),
        curved(SourceProjection::Fisheye),
    ]
}

#[test]
fn every_filter_fills_panels_as_its_twin_does() {
    let gpu = Gpu::open_blocking().unwrap();
    let picture = wavy([320, 240]);
    let panels = three([80, 60]);
    for placement in projections() {
        let plan = plan_of(&panels, &placement, picture.size);
        for filter in WarpFilter::ALL {
            let what = format!("{:?}", placement.projection);
            assert_as_twin(&gpu, &picture, &plan, &style(filter), &what);
        }
    }
    let painted = WarpStyle {
        filter: WarpFilter::Feline,
        paints: true,
    };
    let plan = plan_of(&panels, &seed_plane(), picture.size);
    assert_as_twin(&gpu, &picture, &plan, &painted, "painted");
}

#[test]
fn panels_with_optics_that_fade_and_are_turned_are_filled_as_by_their_twin() {
    let gpu = Gpu::open_blocking().unwrap();
    let picture = wavy([300, 200]);
    let mut panels = three([96, 72]);
    panels[0].scanout = Scanout::Rot90;
    panels[0].distortion = Distortion::Bulge(Bulge { height: 0.15 });
    panels[1] = Panel {
        scanout: Scanout::FlipX,
        gain: [0.9, 1.0, 0.7],
        ..colour_lens(panels[1].clone())
    };
    panels[2].black = 0.05;
    for (panel, size) in panels.iter_mut().zip([[96, 72]; 3]) {
        let fade = |k: u32| (k * 7919 % 65_536) as u16;
        let shares = (0..size[0] * size[1]).map(fade).collect();
        panel.alpha = Some(AlphaMap::new(size, shares).into());
    }
    for panel in &mut panels {
        panel.blend = 0.2;
    }
    for placement in projections() {
        let plan = plan_of(&panels, &placement, picture.size);
        assert_eq!(plan.panels.iter().map(|it| it.channels).max(), Some(3));
        for filter in [WarpFilter::Bilinear, WarpFilter::Auto] {
            let what = format!("optics {:?}", placement.projection);
            assert_as_twin(&gpu, &picture, &plan, &style(filter), &what);
        }
    }
}

/// A device that binds so many bytes at most, and gives a shader so many buffers.
fn narrow(bytes: u64, buffers: u32) -> Gpu {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let options = wgpu::RequestAdapterOptions::default();
    let adapter = pollster::block_on(instance.request_adapter(&options)).unwrap();
    let opened = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: wgpu::Limits {
            max_storage_buffer_binding_size: bytes,
            max_storage_buffers_per_shader_stage: buffers,
            ..wgpu::Limits::default().or_worse_values_from(&adapter.limits())
        },
        ..wgpu::DeviceDescriptor::default()
    }));
    let (device, queue) = opened.unwrap();
    Gpu::from_parts(device, queue)
}

#[test]
fn panels_whose_maps_are_more_than_a_device_binds_are_drawn_in_turn() {
    let picture = wavy([320, 240]);
    let mut panels = three([80, 60]);
    panels[1].scanout = Scanout::Rot90;
    let fade = |k: u32| (k * 7919 % 65_536) as u16;
    let shares = (0..80 * 60).map(fade).collect();
    panels[2] = colour_lens(panels[2].clone());
    panels[2].alpha = Some(AlphaMap::new([80, 60], shares).into());
    let plan = plan_of(&panels, &seed_plane(), picture.size);
    let map = |panel: &Panel| {
        let pixels = panel.pixels() as usize;
        let texel = |k: usize| SeedTexel {
            whole: [(k % 300) as u16, (k % 200) as u16],
            fraction: [(k * 77 % 65_536) as u16; 2],
            change: [32, 0, 0, 32],
        };
        (0..pixels).map(texel).collect::<Vec<_>>()
    };
    let maps: Vec<Vec<SeedTexel>> = panels.iter().map(map).collect();
    let maps: Vec<&[SeedTexel]> = maps.iter().map(Vec::as_slice).collect();
    // A map has 57,600 bytes.
    let gpu = narrow(1 << 16, 8);
    for plan in [plan.clone(), plan.clone().by_seed_maps(&maps)] {
        assert_as_twin(
            &gpu,
            &picture,
            &plan,
            &style(WarpFilter::Trilinear),
            "in turn",
        );
    }
    for (gpu, limit) in [
        (narrow(1 << 15, 8), "max_storage_buffer_binding_size"),
        (narrow(1 << 16, 5), "max_storage_buffers_per_shader_stage"),
    ] {
        let refused = Warper::new(&gpu).load(&plan.clone().by_seed_maps(&maps));
        let told = refused.err().unwrap().to_string();
        assert!(told.contains(limit), "{told}");
    }
}

#[test]
fn records_lead_to_the_places_of_the_pixel_map() {
    let source = [1600, 1200];
    let mut panels = three([800, 600]);
    panels[0].scanout = Scanout::Rot270;
    panels[1].distortion = Distortion::Bulge(Bulge { height: 0.15 });
    panels[2] = colour_lens(panels[2].clone());
    for placement in projections() {
        let plan = plan_of(&panels, &placement, source);
        for (index, panel) in panels.iter().enumerate() {
            let map = PixelMap {
                panel,
                placement: &placement,
                size: source,
            };
            let back = panel.scanout.seen_from_sent(panel.view.size);
            // Optics are as good as their grid; the fold of a bulge is smoothed over 4 pixels.
            let most = match panel.distortion {
                Distortion::None => 2e-3,
                Distortion::Bulge(_) => 0.25,
                _ => 0.05,
            };
            let channel = if panel.distortion.parts_colours() {
                0
            } else {
                GREEN
            };
            for k in 0..500_u32 {
                let [w, h] = panel.sent_size();
                let sent = [(k * 37 % w) as f32 + 0.5, (k * 61 % h) as f32 + 0.5];
                let seen = back * glam::DVec3::new(sent[0].into(), sent[1].into(), 1.0);
                let expected = map.of_channel([seen.x, seen.y], channel).unwrap().place;
                let inside =
                    (0..2).all(|k| (1.0..f64::from(source[k]) - 1.0).contains(&expected[k]));
                let found = twin::warped_place(&plan, index, sent);
                assert!(found.is_some() || !inside, "{} {sent:?}", panel.id);
                for (found, expected) in found.into_iter().flatten().zip(expected) {
                    let off = (f64::from(found) - expected).abs();
                    assert!(off < most, "{} {sent:?}: {found} for {expected}", panel.id);
                }
            }
        }
    }
}

#[test]
fn the_error_that_fit_tells_of_maps_is_that_of_the_records_that_are_drawn_by() {
    let source = [1600, 1200];
    let mut panels = three([400, 300]);
    panels[0].scanout = Scanout::Rot90;
    panels[0].distortion = Distortion::Bulge(Bulge { height: 0.15 });
    panels[2] = colour_lens(panels[2].clone());
    for panel in [&panels[0], &panels[2]] {
        for rule in [PlacementRule::Plane, PlacementRule::Equirect] {
            let found = fit(&[panel], rule, Some(source)).unwrap();
            let map = PixelMap {
                panel,
                placement: &found.placement,
                size: source,
            };
            let plan = plan_of(std::slice::from_ref(panel), &found.placement, source);
            let back = panel.scanout.seen_from_sent(panel.view.size);
            let channel = if plan.panels[0].channels == 3 {
                0
            } else {
                GREEN
            };
            let [w, h] = panel.sent_size();
            let mut worst = 0.0_f64;
            for sent in (0..h).flat_map(|y| (0..w).map(move |x| [x as f32 + 0.5, y as f32 + 0.5])) {
                let seen = back * glam::DVec3::new(sent[0].into(), sent[1].into(), 1.0);
                let expected = map.of_channel([seen.x, seen.y], channel).unwrap().place;
                let Some(found) = twin::warped_place(&plan, 0, sent) else {
                    continue;
                };
                let [x, y] = [0, 1].map(|k| f64::from(found[k]) - expected[k]);
                worst = worst.max(x.hypot(y));
            }
            println!(
                "{} {rule:?}: {worst:.4} of {:.4}",
                panel.id, found.map_error
            );
            // The record has f32, and pixel centres miss the worst places by a little.
            assert!(
                worst <= found.map_error + 2e-3,
                "{worst}, {}",
                found.map_error
            );
            assert!(
                worst >= 0.5 * found.map_error,
                "{worst}, {}",
                found.map_error
            );
        }
    }
}

#[test]
fn a_flat_panel_takes_128_bytes_and_no_map() {
    let plan = plan_of(&three([800, 600]), &seed_plane(), [1600, 1200]);
    assert_eq!(plan.bytes(), 3 * 128);
    assert_eq!(plan.atlas, [2400, 600]);
}

/// A panel that shows a plane pixel for pixel.
fn window(size: [u32; 2]) -> (Panel, Placement) {
    let [w, h] = size.map(|side| f64::from(side) / 500.0);
    let placement = Placement::new(
        SourceProjection::Plane,
        Axes::FRONT,
        [w / 2.0, w / 2.0, h / 2.0, h / 2.0],
    );
    (panel("all", [0.0; 3], [w, h], size), placement)
}

#[test]
fn a_panel_that_is_the_source_shows_it_byte_for_byte_by_every_filter() {
    let gpu = Gpu::open_blocking().unwrap();
    let picture = wavy([96, 64]);
    let (panel, placement) = window(picture.size);
    let plan = plan_of(&[panel], &placement, picture.size);
    for filter in WarpFilter::ALL {
        let drawn = on_gpu(&gpu, &picture, &plan, &style(filter));
        let (worst, _) = difference(&drawn, &picture);
        assert!(worst <= 1, "{filter:?}: {worst}");
        if filter == WarpFilter::Bilinear {
            assert_eq!(drawn, picture);
        }
    }
}

/// Where a pixel that is seen is sent: the display is turned by hand.
fn sent_from_seen(scanout: Scanout, [w, h]: [u32; 2], [x, y]: [u32; 2]) -> [u32; 2] {
    match scanout {
        Scanout::Normal => [x, y],
        Scanout::Rot90 => [h - 1 - y, x],
        Scanout::Rot180 => [w - 1 - x, h - 1 - y],
        Scanout::Rot270 => [y, w - 1 - x],
        Scanout::FlipX => [w - 1 - x, y],
        Scanout::FlipY => [x, h - 1 - y],
    }
}

#[test]
fn a_picture_that_tells_its_places_comes_out_turned_and_where_it_is_sent() {
    let gpu = Gpu::open_blocking().unwrap();
    let size = [40, 24];
    let code = |x: u32, y: u32| [(x * 5) as u8, (y * 9) as u8, ((x + y) % 7 * 30) as u8, 255];
    let mut picture = RgbaImage::black(size);
    for y in 0..size[1] {
        for x in 0..size[0] {
            picture.set_pixel([x, y], code(x, y));
        }
    }
    let (flat, placement) = window(size);
    let panels = Scanout::ALL.map(|scanout| Panel {
        scanout,
        ..flat.clone()
    });
    let origin = |k: usize| [7 + 43 * k as u32, 3 + 5 * k as u32];
    let placed: Vec<PanelOnSource<'_>> = panels
        .iter()
        .enumerate()
        .map(|(k, panel)| PanelOnSource {
            panel,
            placement: &placement,
            part: [0, 0, size[0], size[1]],
            origin: origin(k),
        })
        .collect();
    let plan = WarpPlan::new(&placed);
    let drawn = on_gpu(&gpu, &picture, &plan, &style(WarpFilter::Bilinear));
    let mut expected = RgbaImage::black(plan.atlas);
    for (k, scanout) in Scanout::ALL.into_iter().enumerate() {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let sent = sent_from_seen(scanout, size, [x, y]);
                let at = [0, 1].map(|axis| origin(k)[axis] + sent[axis]);
                expected.set_pixel(at, code(x, y));
            }
        }
    }
    assert_eq!(drawn, expected);
}

fn linear(code: u8) -> f64 {
    let code = f64::from(code) / 255.0;
    match code <= 0.04045 {
        true => code / 12.92,
        false => ((code + 0.055) / 1.055).powf(2.4),
    }
}

fn coded(light: f64) -> f64 {
    match light <= 0.003_130_8 {
        true => 12.92 * light * 255.0,
        false => (1.055 * light.powf(1.0 / 2.4) - 0.055) * 255.0,
    }
}

/// Linear light of a channel between the pixels of a part of a picture.
fn light_between(image: &RgbaImage, origin: [u32; 2], size: [u32; 2], place: [f64; 2]) -> f64 {
    let at = place.map(|k| k - 0.5);
    let texel = |dx: u32, dy: u32| {
        let low = [
            at[0].floor() as i64 + i64::from(dx),
            at[1].floor() as i64 + i64::from(dy),
        ];
        let inside = [0, 1].map(|k| low[k].clamp(0, i64::from(size[k]) - 1) as u32 + origin[k]);
        linear(image.pixel(inside)[0])
    };
    let [x, y] = at.map(|k| k - k.floor());
    let mix = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
    mix(
        mix(texel(0, 0), texel(1, 0), x),
        mix(texel(0, 1), texel(1, 1), x),
        y,
    )
}

#[test]
fn white_on_overlapping_panels_that_fade_is_flat_within_one_code() {
    let gpu = Gpu::open_blocking().unwrap();
    // Two by two, each 40 degrees wide and 30 apart: in the middle four overlap.
    let size = [240, 200];
    let mut panels = Vec::new();
    for (row, pitch) in [-12.0, 12.0].into_iter().enumerate() {
        for (column, yaw) in [-15.0, 15.0].into_iter().enumerate() {
            let mut it = panel(
                &format!("{row}{column}"),
                [0.0, pitch, yaw],
                [0.73, 0.6],
                size,
            );
            it.blend = f64::to_radians(9.0);
            panels.push(it);
        }
    }
    let white = painted([64, 64], |_, _| [255.0; 3]);
    let wide = Placement::new(
        SourceProjection::Equirect,
        Axes::FRONT,
        [2.0, 2.0, 1.5, 1.5],
    );
    let plan = plan_of(&panels, &wide, white.size);
    let drawn = on_gpu(&gpu, &white, &plan, &style(WarpFilter::Bilinear));
    let (mut worst, mut shared, mut beyond) = (0.0_f64, 0, 0);
    for own in &panels {
        for k in 0..4000_u32 {
            let place = [
                f64::from(k * 7 % size[0]) + 0.5,
                f64::from(k * 13 % size[1]) + 0.5,
            ];
            let ray = own.view.ray(place);
            let places: Vec<_> = panels.iter().map(|other| other.view.place(ray)).collect();
            // Pixels round a panel's edge lie half in it: between them nothing is known.
            let within = |at: [f64; 2], border: f64| {
                (0..2).all(|k| (border..f64::from(size[k]) - border).contains(&at[k]))
            };
            let is_edge = |at: &[f64; 2]| within(*at, -1.0) && !within(*at, 1.0);
            if places.iter().flatten().any(is_edge) {
                continue;
            }
            let seen = places.iter().enumerate().filter_map(|(index, at)| {
                let at = at.filter(|at| within(*at, 1.0))?;
                let origin = [size[0] * index as u32, 0];
                Some(light_between(&drawn, origin, size, at))
            });
            let seen: Vec<f64> = seen.collect();
            shared += usize::from(seen.len() > 1);
            let off = (coded(seen.iter().sum()) - 255.0).abs();
            beyond += usize::from(off > 1.0);
            worst = worst.max(off);
        }
    }
    println!("flat white: worst {worst:.3} codes, {beyond} of {shared}");
    // Where edges of two panels cross, shares change within a pixel, and between pixels is neither.
    assert!(beyond * 500 <= shared && worst <= 3.0 && shared > 4000);
}

#[test]
fn black_is_lifted_where_fewer_panels_overlap() {
    let gpu = Gpu::open_blocking().unwrap();
    let black = RgbaImage::black([16, 16]);
    let mut panels = vec![
        panel("a", [0.0, 0.0, -12.0], [0.7, 0.5], [120, 80]),
        panel("b", [0.0, 0.0, 12.0], [0.7, 0.5], [120, 80]),
    ];
    for it in &mut panels {
        it.black = 0.05;
        it.blend = 0.1;
    }
    let wide = Placement::new(
        SourceProjection::Equirect,
        Axes::FRONT,
        [2.0, 2.0, 1.5, 1.5],
    );
    let plan = plan_of(&panels, &wide, black.size);
    let drawn = on_gpu(&gpu, &black, &plan, &style(WarpFilter::Bilinear));
    let lifted = coded(0.05).round() as u8;
    assert_eq!(drawn.pixel([5, 40])[0], lifted);
    assert_eq!(drawn.pixel([115, 40])[0], 0);
    assert_eq!(drawn.pixel([125, 40])[0], 0);
    assert_eq!(drawn.pixel([235, 40])[0], lifted);
}

#[test]
fn a_frame_of_another_size_and_a_source_larger_than_the_device_holds_are_refused() {
    let gpu = Gpu::open_blocking().unwrap();
    let source = SourceTexture::new(&gpu, [32, 16], false).unwrap();
    let wrong = source.write(&gpu, &RgbaImage::black([16, 32])).unwrap_err();
    assert!(wrong.to_string().contains("[32, 16]"), "{wrong}");
    let large = SourceTexture::new(&gpu, [1 << 20, 16], false)
        .err()
        .unwrap();
    assert!(large.to_string().contains("1048576"), "{large}");
    let placed = Panel {
        view: foveal_core::view::eye_view::EyeView {
            field: Field::symmetric([1.0, 1.0]),
            ..window([1 << 17, 8]).0.view
        },
        ..window([8, 8]).0
    };
    let plan = plan_of(&[placed], &seed_plane(), [8, 8]);
    let large = Warper::new(&gpu).load(&plan).err().unwrap();
    assert!(large.to_string().contains("131072"), "{large}");
}

/// Decibels of filters on the upper left panel of twelve, against the mean of 16 x 16 places a
/// pixel, on every fourth row.
fn stretched(picture: &RgbaImage, filters: &[WarpFilter]) -> Vec<f64> {
    let gpu = Gpu::open_blocking().unwrap();
    let size = [800, 600];
    let plan = plan_of(&[upper_left(size)], &seed_plane_of_twelve(), picture.size);
    let rows: Vec<u32> = (0..size[1]).step_by(4).collect();
    let mut best = RgbaImage::black([size[0], rows.len() as u32]);
    for (line, y) in rows.iter().enumerate() {
        for x in 0..size[0] {
            let mut sum = 0.0;
            for k in 0..256_u32 {
                let within = [k % 16, k / 16].map(|k| (k as f32 + 0.5) / 16.0);
                let place = [x as f32 + within[0], *y as f32 + within[1]];
                if let Some(at) = twin::warped_place(&plan, 0, place) {
                    let at = at.map(f64::from);
                    sum += light_between(picture, [0, 0], picture.size, at) / 256.0;
                }
            }
            let code = coded(sum).round() as u8;
            best.set_pixel([x, line as u32], [code, code, code, 255]);
        }
    }
    let score = |filter: &WarpFilter| {
        let drawn = on_gpu(&gpu, picture, &plan, &style(*filter));
        let mut kept = RgbaImage::black(best.size);
        for (line, y) in rows.iter().enumerate() {
            for x in 0..size[0] {
                kept.set_pixel([x, line as u32], drawn.pixel([x, *y]));
            }
        }
        psnr(&kept, &best)
    };
    filters.iter().map(score).collect()
}

#[test]
fn on_a_stretched_panel_feline_and_anisotropic_beat_trilinear_by_five_db() {
    // The lines of `foveal panels pattern grid`.
    let grid = painted([1600, 1200], |x, y| {
        let is_line = (x + 1.0).rem_euclid(16.0) < 2.0 || (y + 9.0).rem_euclid(16.0) < 2.0;
        [if is_line { 235.0 } else { 24.0 }; 3]
    });
    let filters = [
        WarpFilter::Trilinear,
        WarpFilter::Anisotropic,
        WarpFilter::Feline,
    ];
    let all = stretched(&grid, &filters);
    println!("{filters:?}: {all:.2?} dB");
    assert!(all[1] >= all[0] + 5.0, "{all:?}");
    assert!(all[2] >= all[0] + 5.0, "{all:?}");
}
