//! Do the passes still draw what a person has looked at?
//!
//! `FOVEAL_BLESS=1` rewrites the pictures of `tests/golden`; `FOVEAL_LARGE=FOLDER` also writes the
//! same scenes at 800x600, to be looked at.

use crate::common::panels::{blurred_plan_of, curved, painted, plan_of, seed_plane, three};
use crate::common::torus::{self, coming, coming_root, from_above};
use crate::common::*;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::panel::distortion::Distortion;
use foveal_core::view::panel::eye_blur::EyeBlur;
use foveal_core::view::panel::lens::Bulge;
use foveal_core::view::panel::placement::{Placement, SourceProjection};
use foveal_core::view::panel::rig::{Panel, Scanout};
use foveal_core::view::surface::{Eye, Surface};
use foveal_render::warp::{SourceTexture, WarpFilter, WarpStyle, Warper};
use foveal_render::{Gpu, Overlay, RgbaImage, SceneLayer, SceneStyle};
use std::path::Path;

/// Largest golden file in bytes.
const MOST_BYTES: u64 = 32 * 1024;

/// Draws a scene, compares it with its golden, and writes it large where that is asked for.
fn assert_golden(
    name: &str,
    scene: &Scene,
    tiles: &[Tile],
    view: &EyeView,
    marks: Option<Overlay>,
) {
    let gpu = Gpu::open_blocking().unwrap();
    let mut renderer = scene.on_gpu(&gpu, tiles);
    let mut draw = |view: &EyeView, zoom: f32| match marks {
        None => renderer.reconstruct(view).unwrap(),
        Some(marks) => {
            let gaze = marks.gaze.map(|g| g * zoom);
            let gaze_radius = marks.gaze_radius * zoom;
            let marks = Overlay {
                gaze,
                gaze_radius,
                ..marks
            };
            renderer.heat_map(view, &marks).unwrap()
        }
    };
    if let Ok(folder) = std::env::var("FOVEAL_LARGE") {
        let large = EyeView {
            size: [800, 600],
            ..*view
        };
        let image = draw(&large, 800.0 / view.size[0] as f32);
        write_png(&Path::new(&folder).join(format!("{name}.png")), &image);
    }
    let drawn = draw(view, 1.0);
    assert_picture(name, &drawn);
}

/// Compares a picture with its golden.
fn assert_picture(name: &str, drawn: &RgbaImage) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"));
    if std::env::var("FOVEAL_BLESS").is_ok_and(|v| v == "1") {
        write_png(&path, drawn);
    }
    assert!(
        std::fs::metadata(&path).unwrap().len() <= MOST_BYTES,
        "{name} is too large"
    );
    let (worst, _) = difference(drawn, &read_png(&path));
    assert!(
        worst <= 2,
        "{name} differs by {worst}; look at it, then bless it"
    );
}

fn plane(cut: Cut, levels: u8, ratio: u32) -> Scene {
    let grid = TileGrid::new(flat([800, 600]), cut, levels, ratio).unwrap();
    Scene::new(grid, LIMITED, |_, [x, y]| {
        detail(x / 100.0 - 4.0, y / 100.0 - 3.0, 0.0)
    })
}

fn plane_view(scene: &Scene) -> EyeView {
    EyeView::filling(&scene.grid.surface, [96, 72])
}

fn cube() -> Scene {
    let surface = Surface::cube(512);
    let grid = TileGrid::new(surface, Cut::Tile(64), 4, 2).unwrap();
    Scene::new(grid, FULL, |face, place| {
        detail_around(&surface, face, place)
    })
}

fn marks() -> Overlay {
    Overlay {
        gaze: [48.0, 36.0],
        gaze_radius: 9.0,
        borders: 0.7,
        ..Overlay::default()
    }
}

#[test]
fn a_plane_of_fine_tiles() {
    let scene = plane(Cut::Tile(64), 4, 2);
    assert_golden(
        "plane_fine",
        &scene,
        &scene.finest(),
        &plane_view(&scene),
        None,
    );
}

#[test]
fn a_plane_fine_round_the_gaze() {
    let scene = plane(Cut::Tile(64), 4, 2);
    let tiles = fine_around(&scene.grid, 0, [400.0, 300.0], [90.0, 60.0]);
    let view = window(&scene.grid.surface, [200.0, 150.0], [96, 72], 0.24);
    assert_golden("plane_gaze", &scene, &tiles, &view, None);
    assert_golden(
        "plane_levels",
        &scene,
        &tiles,
        &plane_view(&scene),
        Some(marks()),
    );
}

#[test]
fn a_plane_of_a_grid_seen_from_beside() {
    let scene = plane(Cut::Grid([8, 6]), 3, 4);
    let tiles = fine_around(&scene.grid, 0, [400.0, 300.0], [120.0, 80.0]);
    let view = turned([12.0, -6.0, 15.0], 40.0, [96, 72]);
    assert_golden("grid_beside", &scene, &tiles, &view, None);
}

#[test]
fn a_cube_of_fine_tiles_at_a_corner() {
    let scene = cube();
    let view = turned([45.0, 35.26, 0.0], 70.0, [96, 72]);
    assert_golden("cube_fine", &scene, &scene.finest(), &view, None);
}

#[test]
fn a_cube_fine_round_a_gaze_at_an_edge() {
    let scene = cube();
    let tiles = fine_around(&scene.grid, 0, [500.0, 120.0], [70.0, 45.0]);
    let view = turned([45.0, 25.0, 0.0], 60.0, [96, 72]);
    assert_golden("cube_gaze", &scene, &tiles, &view, None);
    assert_golden("cube_levels", &scene, &tiles, &view, Some(marks()));
    assert_golden("cube_coarsest", &scene, &[], &view, None);
}

#[test]
fn a_sphere_fine_round_a_gaze_at_its_seam_and_near_a_pole() {
    let surface = Surface::equirect([2048, 1024]);
    let grid = TileGrid::new(surface, Cut::Tile(128), 4, 2).unwrap();
    let scene = Scene::new(grid, FULL, |face, place| {
        detail_around(&surface, face, place)
    });
    let tiles = fine_around(&grid, 0, [20.0, 200.0], [60.0, 20.0]);
    let view = turned([180.0, 65.0, 0.0], 70.0, [96, 72]);
    assert_golden("equirect_gaze", &scene, &tiles, &view, None);
    assert_golden("equirect_levels", &scene, &tiles, &view, Some(marks()));
}

#[test]
fn a_panorama_without_poles_at_the_corner_of_a_face_for_the_right_eye() {
    let surface = Surface::cube(512).without_poles().for_two_eyes();
    let grid = TileGrid::new(surface, Cut::Tile(64), 4, 2).unwrap();
    let scene = Scene::new(grid, FULL, |face, place| {
        let [y, u, v] = detail_around(&surface, face, place);
        if face < 4 { [y, v, u] } else { [y, u, v] }
    });
    let right = surface.first_face(Eye::Right);
    let tiles = fine_around(&scene.grid, right, [500.0, 120.0], [70.0, 45.0]);
    let view = of_right_eye(turned([45.0, 30.0, 0.0], 70.0, [96, 72]));
    assert_golden("panorama_right_eye", &scene, &tiles, &view, None);
}

#[test]
fn a_cloud_refined_in_part() {
    let gpu = Gpu::open_blocking().unwrap();
    let mut layer = SceneLayer::new(&gpu, &[ball::cloud()], &[], 1 << 24).unwrap();
    let [root, fine] = ball::units();
    layer.upload(&ball::coming(ball::ROOT, &root, 0)).unwrap();
    layer.upload(&ball::coming(ball::FINE, &fine, 0)).unwrap();
    let view = torus::view([0.0, 0.4, 4.0], [0.0, -6.0], [96, 64]);
    let tinted = SceneStyle {
        tint: 0.5,
        ..SceneStyle::default()
    };
    assert_picture(
        "points",
        &layer.picture(&view, &SceneStyle::default()).unwrap(),
    );
    assert_picture("points_levels", &layer.picture(&view, &tinted).unwrap());
}

#[test]
fn a_torus_of_meshes_refined_in_part() {
    let gpu = Gpu::open_blocking().unwrap();
    let objects = [torus::object(torus::ALL)];
    let mut layer = SceneLayer::new(&gpu, &objects, &[], 1 << 20).unwrap();
    let (root, fine) = (torus::root(), torus::refinement(&[5, 6]));
    layer.upload(&coming_root(&root)).unwrap();
    layer.upload(&coming(1, &fine)).unwrap();
    let tinted = SceneStyle {
        tint: 0.5,
        ..SceneStyle::default()
    };
    let view = from_above([96, 64]);
    let plain = layer.picture(&view, &SceneStyle::default()).unwrap();
    assert_picture("meshes", &plain);
    assert_picture("meshes_levels", &layer.picture(&view, &tinted).unwrap());
    let (refiners, worths) = torus::worth_by_cluster();
    layer.set_refiners(refiners);
    layer.mark(Some(&worths)).unwrap();
    let marked = layer.picture(&view, &SceneStyle::default()).unwrap();
    assert_picture("meshes_worth", &marked);
    layer.mark(None).unwrap();
    assert_eq!(layer.picture(&view, &SceneStyle::default()).unwrap(), plain);
}

/// Panels filled from crisp content.
fn assert_filled(name: &str, panels: &[Panel], placement: &Placement, style: &WarpStyle) {
    assert_seen(name, (panels, placement), None, style);
}

/// The same, as an eye sees them.
fn assert_seen(
    name: &str,
    (panels, placement): (&[Panel], &Placement),
    eye: Option<&EyeBlur>,
    style: &WarpStyle,
) {
    let gpu = Gpu::open_blocking().unwrap();
    let picture = painted([400, 300], |x, y| {
        let [luma, u, v] = detail(x / 60.0 - 3.3, y / 60.0 - 2.5, 0.0);
        [
            luma,
            (luma + u - 128.0).clamp(0.0, 255.0),
            (luma + v - 128.0).clamp(0.0, 255.0),
        ]
    });
    let plan = match eye {
        Some(eye) => blurred_plan_of(panels, placement, picture.size, eye),
        None => plan_of(panels, placement, picture.size),
    };
    let warper = Warper::new(&gpu);
    let source = SourceTexture::new(&gpu, picture.size, true).unwrap();
    source.write(&gpu, &picture).unwrap();
    let loaded = warper.load(&plan).unwrap();
    let drawn = warper.read(&loaded, &source, style).wait(&gpu).unwrap();
    assert_picture(name, &drawn);
}

#[test]
fn three_panels_filled_from_a_plane() {
    let auto = WarpStyle::default();
    assert_filled("warp_three", &three([60, 45]), &seed_plane(), &auto);
    let painted = WarpStyle {
        filter: WarpFilter::Feline,
        paints: true,
    };
    assert_filled("warp_painted", &three([60, 45]), &seed_plane(), &painted);
}

#[test]
fn three_panels_as_an_eye_with_astigmatism_sees_them() {
    let panels = three([60, 45]);
    let (placement, eye) = (seed_plane(), EyeBlur::new(-8.0, 45.0, 4.0));
    let style = WarpStyle::default();
    assert_seen("warp_blurred", (&panels, &placement), Some(&eye), &style);
}

#[test]
fn turned_panels_with_optics_that_fade_filled_from_a_curved_source() {
    let mut panels = three([60, 45]);
    panels[0].scanout = Scanout::Rot90;
    panels[1].distortion = Distortion::Bulge(Bulge { height: 0.3 });
    panels.iter_mut().for_each(|it| it.blend = 0.2);
    let curved = curved(SourceProjection::Equirect);
    assert_filled("warp_faded", &panels, &curved, &WarpStyle::default());
}
