//! Do samples, blur and textures show what they say, and as their twins on the CPU do?

use crate::common::*;
use foveal_core::content::video::grid::gather::Gather;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::perception::acuity::AcuityModel;
use foveal_core::perception::samples::sample_mask::{MaskShape, SampleMask};
use foveal_core::units::Radians;
use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Surface;
use foveal_render::twin::{self, TwinSamples};
use foveal_render::{Gpu, Interpolation, RadialBlur, Renderer, RgbaImage, TextureRenderer};
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;

const BOTH: [Interpolation; 2] = [Interpolation::Nearest, Interpolation::Blended];
/// A mask smaller than the view, so that its border shows.
const SIDE: u32 = 150;
const SAMPLES: u32 = 4200;

fn scene(cut: Cut) -> Scene {
    let grid = TileGrid::new(flat([283, 171]), cut, 3, 4).unwrap();
    Scene::new(grid, LIMITED, waves)
}

fn crisp() -> Scene {
    let grid = TileGrid::new(flat([400, 300]), Cut::Grid([4, 4]), 3, 4).unwrap();
    Scene::new(grid, LIMITED, |_, [x, y]| {
        detail(x / 50.0 - 4.0, y / 50.0 - 3.0, 0.0)
    })
}

fn mask_of(view: &EyeView, side: u32, samples: u32) -> SampleMask {
    let pitch = (view.field.left + view.field.right) / f64::from(view.size[0]);
    let shape = MaskShape {
        side,
        pitch,
        eye: AcuityModel::LINEAR,
    };
    SampleMask::new(&shape, Some(samples))
}

/// The colours of a mask round a place of the view, from all finest tiles.
fn codes(scene: &Scene, view: &EyeView, mask: &SampleMask, corner: [i32; 2]) -> Vec<u32> {
    let cells = scene.grid.tiles_of(0);
    let tiles: BTreeMap<Tile, Picture> = cells.map(|cell| (cell, scene.tile(cell))).collect();
    Gather::new(&scene.grid, &tiles, 1.0, false).codes(view, corner, &mask.places, |_| 1.0)
}

fn sampled_twin(
    scene: &Scene,
    view: &EyeView,
    mask: &SampleMask,
    corner: [i32; 2],
    interpolation: Interpolation,
) -> RgbaImage {
    let mut samples = TwinSamples::new(mask.clone(), interpolation);
    samples.show(corner, &codes(scene, view, mask, corner));
    twin::interpolate_sparse(&scene.in_memory(&[]), &samples, view)
}

fn sampled_gpu(
    scene: &Scene,
    view: &EyeView,
    mask: &SampleMask,
    corner: [i32; 2],
    interpolation: Interpolation,
) -> RgbaImage {
    let mut renderer = sampled_renderer(scene, view, mask, corner, interpolation);
    renderer.reconstruct(view).unwrap()
}

fn sampled_renderer(
    scene: &Scene,
    view: &EyeView,
    mask: &SampleMask,
    corner: [i32; 2],
    interpolation: Interpolation,
) -> Renderer {
    let gpu = Gpu::open_blocking().unwrap();
    let mut renderer = scene.on_gpu(&gpu, &[]);
    renderer.sample_by(mask, interpolation).unwrap();
    let codes = codes(scene, view, mask, corner);
    renderer.show_samples(corner, &codes).unwrap();
    renderer
}

fn assert_alike(what: &str, drawn: &RgbaImage, expected: &RgbaImage) {
    let (worst, off) = difference(drawn, expected);
    println!("{what}: worst {worst}, beyond 1: {off:.6}");
    assert!(worst <= 3 && off <= 0.001, "{what}: {worst}, {off}");
}

/// Mean squared difference of red, green and blue over the pixels that are `within`.
fn error(a: &RgbaImage, b: &RgbaImage, within: impl Fn([u32; 2]) -> bool) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for y in 0..a.size[1] {
        for x in (0..a.size[0]).filter(|x| within([*x, y])) {
            for k in 0..3 {
                sum += (f64::from(a.pixel([x, y])[k]) - f64::from(b.pixel([x, y])[k])).powi(2);
                count += 1;
            }
        }
    }
    sum / f64::from(count)
}

#[test]
fn samples_are_drawn_as_by_their_twin_within_the_mask_and_beyond() {
    for cut in [Cut::Grid([4, 4]), Cut::Tile(64)] {
        let scene = scene(cut);
        let view = EyeView::filling(&scene.grid.surface, scene.grid.surface.size);
        let mask = mask_of(&view, SIDE, SAMPLES);
        for interpolation in BOTH {
            for corner in [[60, 10], [-40, 90]] {
                let drawn = sampled_gpu(&scene, &view, &mask, corner, interpolation);
                let expected = sampled_twin(&scene, &view, &mask, corner, interpolation);
                assert_alike(&format!("{cut:?} {interpolation:?}"), &drawn, &expected);
            }
        }
    }
}

#[test]
fn the_middle_of_the_mask_is_the_whole_picture_and_beyond_it_the_coarsest_level_is_shown() {
    let scene = scene(Cut::Grid([4, 4]));
    let view = EyeView::filling(&scene.grid.surface, scene.grid.surface.size);
    let mask = mask_of(&view, SIDE, SAMPLES);
    let coarsest = twin::reconstruct(&scene.in_memory(&[]), &view);
    let none = BTreeMap::new();
    let whole = Gather::new(&scene.grid, &none, 1.0, false);
    assert_eq!(whole.codes(&view, [0; 2], &[[3, 3]], |_| 1.0), [0x80_8000]);
    for interpolation in BOTH {
        let shown = sampled_twin(&scene, &view, &mask, [60, 10], interpolation);
        let mut inside = 0;
        for y in 0..171u32 {
            for x in 0..283u32 {
                let at = [x as i32 - 60, y as i32 - 10];
                if at.iter().any(|k| !(0..SIDE as i32).contains(k)) {
                    assert_eq!(shown.pixel([x, y]), coarsest.pixel([x, y]));
                    continue;
                }
                let own = mask.nearest[(at[1] as u32 * SIDE + at[0] as u32) as usize];
                inside += u32::from(mask.places[own as usize].map(i32::from) == at);
            }
        }
        assert_eq!(inside, SAMPLES);
    }
}

#[test]
fn blending_is_nearer_to_the_whole_picture_and_flickers_less() {
    let size = [400, 300];
    let moving = |step: f64| {
        let grid = TileGrid::new(flat(size), Cut::Grid([4, 4]), 3, 4).unwrap();
        Scene::new(grid, FULL, move |_, [x, y]| {
            waves(0, [x + 0.7 * step, y + 0.4 * step])
        })
    };
    let scenes: Vec<Scene> = (0..3).map(|step| moving(f64::from(step))).collect();
    let view = EyeView::filling(&scenes[0].grid.surface, size);
    let mask = mask_of(&view, 300, 6000);
    let outside = |[x, y]: [u32; 2]| {
        let away = [f64::from(x) - 200.0, f64::from(y) - 150.0];
        let radius = (away[0] * away[0] + away[1] * away[1]).sqrt();
        radius > 40.0 && radius < 145.0
    };
    let finest = scenes[0].finest();
    let whole: Vec<RgbaImage> = scenes
        .iter()
        .map(|scene| twin::reconstruct(&scene.in_memory(&finest), &view))
        .collect();
    let figures = BOTH.map(|interpolation| {
        let shown: Vec<RgbaImage> = scenes
            .iter()
            .map(|scene| sampled_twin(scene, &view, &mask, [50, 0], interpolation))
            .collect();
        let still = error(&shown[0], &whole[0], outside);
        // Flicker: how the error itself changes from frame to frame.
        let mut changes = 0.0;
        for k in 1..3 {
            for y in 0..size[1] {
                for x in (0..size[0]).filter(|x| outside([*x, y])) {
                    let error = |k: usize| {
                        let of = |image: &RgbaImage| f64::from(image.pixel([x, y])[1]);
                        of(&shown[k]) - of(&whole[k])
                    };
                    changes += (error(k) - error(k - 1)).powi(2);
                }
            }
        }
        [still, changes]
    });
    let [[nearest, jumps], [blended, changes]] = figures;
    let psnr = |mse: f64| 10.0 * (255.0 * 255.0 / mse).log10();
    println!(
        "outside the fovea: nearest {:.2} dB, blended {:.2} dB; flicker {:.2} dB less",
        psnr(nearest),
        psnr(blended),
        10.0 * (jumps / changes).log10()
    );
    assert!(
        blended < 0.7 * nearest && changes < 0.7 * jumps,
        "{figures:?}"
    );
}

#[test]
fn a_mask_that_does_not_fit_its_samples_is_refused() {
    let scene = scene(Cut::Tile(64));
    let view = EyeView::filling(&scene.grid.surface, [100, 60]);
    let gpu = Gpu::open_blocking().unwrap();
    let mut renderer = scene.on_gpu(&gpu, &[]);
    let mask = mask_of(&view, 40, 300);
    renderer.sample_by(&mask, Interpolation::Nearest).unwrap();
    let said = renderer.show_samples([0; 2], &[0; 299]).unwrap_err();
    let said = said.to_string();
    assert!(said.contains("300") && said.contains("299"), "{said}");
}

/// Views, how they are blurred, what they show sharp, and at half the size.
fn blurred_views() -> Vec<(EyeView, RadialBlur, [RgbaImage; 2])> {
    let scene = crisp();
    let finest = scene.in_memory(&scene.finest());
    let filling = EyeView::filling(&scene.grid.surface, [241, 181]);
    let near = EyeView::filling(&Surface::cube(64), [160, 121]);
    [
        (filling, [90.0, 60.0]),
        (near, [20.0, 100.0]),
        (turned([5.0, 3.0, 9.0], 70.0, [64, 64]), [40.0, 30.0]),
    ]
    .into_iter()
    .map(|(view, place)| {
        let gaze = view.ray(place).normalize();
        let views = [view, RadialBlur::half_view(&view)];
        let pictures = views.map(|view| twin::reconstruct(&finest, &view));
        (view, RadialBlur::round(gaze), pictures)
    })
    .collect()
}

#[test]
fn the_fovea_is_untouched_and_detail_goes_with_eccentricity() {
    for (view, blur, [picture, half]) in blurred_views() {
        for half in [Some(half), None] {
            let blurred = twin::blur_radial(&picture, half, &view, &blur);
            let mut changed = 0;
            for_every_ray(&view, |at, ray| {
                let same = blurred.pixel(at) == picture.pixel(at);
                if angle_between(blur.gaze, ray) < Radians::from_degrees(2.5) {
                    assert!(same, "{at:?}");
                } else {
                    changed += u32::from(!same);
                }
            });
            assert!(changed > view.size[0] * view.size[1] / 40, "{changed}");
        }
    }
}

fn for_every_ray(view: &EyeView, mut look: impl FnMut([u32; 2], DVec3)) {
    for y in 0..view.size[1] {
        for x in 0..view.size[0] {
            let ray = view.ray([f64::from(x) + 0.5, f64::from(y) + 0.5]);
            look([x, y], ray.normalize());
        }
    }
}

#[test]
fn a_picture_of_one_colour_stays_as_it_is() {
    let (view, blur, pictures) = blurred_views().remove(0);
    let [grey, half] = pictures.map(|mut picture| {
        let pixels = picture.pixels.chunks_mut(4);
        pixels.for_each(|pixel| pixel.copy_from_slice(&[90, 140, 30, 255]));
        picture
    });
    for half in [Some(half), None] {
        assert_eq!(twin::blur_radial(&grey, half, &view, &blur), grey);
    }
}

/// Mean squared step from a pixel to the one on its right.
fn roughness(picture: &RgbaImage) -> f64 {
    let [width, height] = picture.size;
    let mut right = RgbaImage::black(picture.size);
    for y in 0..height {
        for x in 0..width - 1 {
            right.set_pixel([x, y], picture.pixel([x + 1, y]));
        }
    }
    error(picture, &right, |[x, _]| x + 1 < width)
}

#[test]
fn a_half_that_is_drawn_is_as_soft_as_one_that_is_made_of_the_whole() {
    for (view, blur, [picture, half]) in blurred_views() {
        let blurred = [Some(half), None].map(|half| {
            roughness(&twin::blur_radial(&picture, half, &view, &blur)) / roughness(&picture)
        });
        let [drawn, made] = blurred;
        println!("{:?}: {drawn:.3} {made:.3}", view.size);
        assert!((drawn / made).ln().abs() < 0.2, "{blurred:?}");
    }
}

#[test]
fn the_blur_is_drawn_as_by_its_twin_and_leaves_the_fovea_on_the_gpu_too() {
    let scene = crisp();
    let gpu = Gpu::open_blocking().unwrap();
    let mut renderer = scene.on_gpu(&gpu, &scene.finest());
    // The last looks far aside: nothing in view is sharp.
    let (view, mut blur, pictures) = blurred_views().remove(0);
    blur.gaze = (view.axes.forward + view.axes.right * 2.0).normalize();
    let aside = (view, blur, pictures);
    for (view, blur, _) in blurred_views().into_iter().chain([aside]) {
        renderer.radial_blur = None;
        let sharp = renderer.reconstruct(&view).unwrap();
        let half = renderer.reconstruct(&RadialBlur::half_view(&view)).unwrap();
        renderer.radial_blur = Some(blur);
        let drawn = renderer.reconstruct(&view).unwrap();
        let expected = twin::blur_radial(&sharp, Some(half), &view, &blur);
        let (worst, _) = difference(&drawn, &expected);
        assert!(worst <= 2, "blur {:?}: {worst}", view.size);
        for_every_ray(&view, |at, ray| {
            if angle_between(blur.gaze, ray) < Radians::from_degrees(2.499) {
                assert_eq!(drawn.pixel(at), sharp.pixel(at), "{at:?}");
            }
        });
    }
}

#[test]
fn the_blur_of_samples_is_made_of_the_whole_picture() {
    let scene = crisp();
    let view = EyeView::filling(&scene.grid.surface, [96, 72]);
    let mask = mask_of(&view, 80, 1200);
    let sharp = sampled_gpu(&scene, &view, &mask, [14, -4], Interpolation::Nearest);
    let blur = RadialBlur::round(view.ray([30.0, 30.0]).normalize());
    let mut renderer = sampled_renderer(&scene, &view, &mask, [14, -4], Interpolation::Nearest);
    renderer.radial_blur = Some(blur);
    let drawn = renderer.reconstruct(&view).unwrap();
    let expected = twin::blur_radial(&sharp, None, &view, &blur);
    assert_alike("blurred samples", &drawn, &expected);
}

fn with_textures(gpu: &Gpu, scene: &Scene, tiles: &[Tile]) -> TextureRenderer {
    let mut renderer = TextureRenderer::new(gpu, &scene.grid, scene.colour).unwrap();
    let stale = scene.grid.tiles_of(0).take(5);
    for tile in stale {
        // A tile of an earlier frame stays where it is and is not shown.
        let [w, h] = scene.grid.tile_size(tile);
        let old = Picture::filled(w, h, [255, 0, 0]);
        renderer.upload(tile, 0, &old).unwrap();
    }
    renderer.begin_frame(1);
    let base = scene.grid.tiles_of(scene.grid.coarsest());
    for tile in base.chain(tiles.iter().copied()) {
        renderer.upload(tile, 1, &scene.tile(tile)).unwrap();
    }
    assert_eq!(renderer.wrong_frame_tiles(), 0);
    renderer
}

#[test]
fn textures_are_drawn_as_by_their_twin() {
    let gpu = Gpu::open_blocking().unwrap();
    let plane = EyeView::filling(&flat([283, 171]), [283, 171]);
    let around = turned([40.0, 30.0, 15.0], 100.0, [120, 90]);
    for (scene, view) in [
        (scene(Cut::Grid([4, 4])), plane),
        (scene(Cut::Tile(32)), plane),
        (cube_waves(94, Cut::Grid([4, 4]), 3, 4), around),
        (cube_waves(100, Cut::Tile(32), 5, 2), around),
    ] {
        let tiles = scene.some_tiles(3);
        let tiles: Vec<Tile> = tiles.into_iter().skip(6).collect();
        let drawn = with_textures(&gpu, &scene, &tiles)
            .reconstruct(&view)
            .unwrap();
        let expected = twin::reconstruct_textures(&scene.in_memory(&tiles), &view);
        assert_alike(&format!("{:?}", scene.grid.cut), &drawn, &expected);
    }
}

#[test]
fn a_level_larger_than_a_texture_is_refused_by_name() {
    let gpu = Gpu::open_blocking().unwrap();
    let grid = TileGrid::new(flat([40_960, 8640]), Cut::Grid([8, 8]), 3, 4).unwrap();
    let said = TextureRenderer::new(&gpu, &grid, FULL)
        .err()
        .unwrap()
        .to_string();
    assert!(said.contains("40960") && said.contains("atlas"), "{said}");
}

/// Compares with a golden picture, or writes it.
fn assert_golden(name: &str, drawn: &RgbaImage) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"));
    if std::env::var("FOVEAL_BLESS").is_ok_and(|v| v == "1") {
        write_png(&path, drawn);
    }
    assert!(
        std::fs::metadata(&path).unwrap().len() <= 32 * 1024,
        "{name} is too large"
    );
    let (worst, _) = difference(drawn, &read_png(&path));
    assert!(
        worst <= 2,
        "{name} differs by {worst}; look at it, then bless it"
    );
}

#[test]
fn the_passes_draw_what_a_person_has_looked_at() {
    let scene = crisp();
    let view = EyeView::filling(&scene.grid.surface, [96, 72]);
    let mask = mask_of(&view, 80, 1200);
    for (name, interpolation) in [("sparse_nearest", BOTH[0]), ("sparse_blended", BOTH[1])] {
        let drawn = sampled_gpu(&scene, &view, &mask, [14, -4], interpolation);
        assert_golden(name, &drawn);
    }
    let gpu = Gpu::open_blocking().unwrap();
    let mut renderer = scene.on_gpu(&gpu, &scene.finest());
    renderer.radial_blur = Some(RadialBlur::round(view.ray([30.0, 30.0]).normalize()));
    assert_golden("blur_radial", &renderer.reconstruct(&view).unwrap());
    let tiles = [
        scene.grid.tile_at(0, 5),
        scene.grid.tile_at(1, 6),
        scene.grid.tile_at(1, 9),
    ];
    let mut textures = with_textures(&gpu, &scene, &tiles);
    assert_golden("textures", &textures.reconstruct(&view).unwrap());
}
