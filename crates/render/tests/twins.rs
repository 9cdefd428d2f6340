//! Do the shaders draw what their twins on the CPU draw?

use crate::common::*;
use foveal_core::content::video::grid::tile_grid::{Cut, TileGrid};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::Colour;
use foveal_core::view::surface::{Mapping, Surface};
use foveal_render::{Gpu, HalvedBy, Overlay, twin};

/// Within 1 of 255 on 99.9 % of all channels, and nowhere more than 3: beyond rounding, a place
/// that falls exactly between two samples may go to either on the two sides.
fn assert_alike(scene: &Scene, view: &EyeView, seed: u64, what: &str) {
    let gpu = Gpu::open_blocking().unwrap();
    let tiles = scene.some_tiles(seed);
    let marks = Overlay {
        gaze: [20.0, 15.0],
        gaze_radius: 12.0,
        borders: 1.0,
        ..Overlay::default()
    };
    let mut renderer = scene.on_gpu(&gpu, &tiles);
    let memory = scene.in_memory(&tiles);
    assert_eq!(renderer.tiles().level_map(), memory.level_map());
    let mut halved = scene.halved_by(HalvedBy::Gpu, &gpu, &tiles);
    let [by_gpu, by_cpu] = [&mut halved, &mut renderer].map(|it| it.reconstruct(view).unwrap());
    assert!(by_gpu == by_cpu, "{what}: halved on the GPU");
    for (name, drawn, expected) in [
        (
            "reconstruct",
            renderer.reconstruct(view).unwrap(),
            twin::reconstruct(&memory, view),
        ),
        (
            "overlay",
            renderer.heat_map(view, &marks).unwrap(),
            twin::heat_map(&memory, view, &marks),
        ),
    ] {
        let (worst, off) = difference(&drawn, &expected);
        println!("{what} {name}: worst {worst}, beyond 1: {off:.6}");
        assert!(
            worst <= 3 && off <= 0.001,
            "{what} {name}: worst {worst}, {off} beyond 1"
        );
    }
}

fn plane_scene(size: [u32; 2], cut: Cut, levels: u8, ratio: u32, colour: Colour) -> Scene {
    let grid = TileGrid::new(flat(size), cut, levels, ratio).unwrap();
    Scene::new(grid, colour, waves)
}

fn plane_views(surface: &Surface) -> Vec<(&'static str, EyeView)> {
    vec![
        ("one to one", EyeView::filling(surface, surface.size)),
        ("minified", EyeView::filling(surface, [61, 37])),
        ("magnified", window(surface, [30.3, 20.7], [150, 90], 3.3)),
        ("tilted", turned([14.0, -9.0, 20.0], 40.0, [160, 120])),
        ("outside", turned([35.0, 10.0, 0.0], 80.0, [80, 60])),
    ]
}

#[test]
fn a_pyramid_on_a_plane_is_drawn_as_by_its_twin() {
    for (n, colour) in [FULL, LIMITED, LEFT].into_iter().enumerate() {
        let scene = plane_scene([283, 171], Cut::Tile(32), 4, 2, colour);
        for (name, view) in plane_views(&scene.grid.surface) {
            assert_alike(
                &scene,
                &view,
                n as u64,
                &format!("pyramid {name} {colour:?}"),
            );
        }
    }
}

#[test]
fn a_grid_on_a_plane_is_drawn_as_by_its_twin() {
    for (n, colour) in [FULL, LEFT].into_iter().enumerate() {
        let scene = plane_scene([283, 171], Cut::Grid([5, 3]), 3, 4, colour);
        for (name, view) in plane_views(&scene.grid.surface) {
            assert_alike(&scene, &view, n as u64, &format!("grid {name} {colour:?}"));
        }
    }
}

#[test]
fn odd_cuts_are_drawn_as_by_their_twin() {
    for (size, cut, levels, ratio) in [
        ([7, 3], Cut::Tile(128), 2, 2),
        ([190, 90], Cut::Tile(20), 5, 2),
        ([64, 48], Cut::Tile(64), 1, 2),
        ([65, 49], Cut::Tile(16), 4, 4),
        ([97, 51], Cut::Grid([8, 4]), 5, 2),
    ] {
        let scene = plane_scene(size, cut, levels, ratio, LIMITED);
        for (name, view) in plane_views(&scene.grid.surface) {
            assert_alike(&scene, &view, 5, &format!("{size:?} {cut:?} {name}"));
        }
    }
}

#[test]
fn a_cube_is_drawn_as_by_its_twin() {
    for (scene, name) in [
        (cube_waves(128, Cut::Tile(32), 4, 2), "pyramid"),
        (cube_waves(100, Cut::Tile(32), 5, 2), "odd pyramid"),
        (cube_waves(94, Cut::Grid([4, 4]), 3, 4), "grid"),
        (cube_waves(64, Cut::Tile(64), 3, 2), "one cell a face"),
    ] {
        for (n, turn) in [[0.0, 0.0, 0.0], [40.0, 30.0, 15.0], [135.0, -80.0, 0.0]]
            .iter()
            .enumerate()
        {
            for (across, size) in [(110.0, [120, 90]), (20.0, [90, 120])] {
                let view = turned(*turn, across, size);
                assert_alike(
                    &scene,
                    &view,
                    n as u64,
                    &format!("cube {name} {turn:?} {across}"),
                );
            }
        }
    }
}

#[test]
fn two_eyes_and_missing_faces_are_drawn_as_by_their_twin() {
    let cube = Surface::cube(100);
    for (surface, cut, name) in [
        (cube.for_two_eyes(), Cut::Tile(32), "two cubes"),
        (
            cube.mapped(Mapping::EquiAngular),
            Cut::Tile(32),
            "equi-angular cube",
        ),
        (
            cube.without_poles().mapped(Mapping::EquiAngular),
            Cut::Grid([4, 4]),
            "equi-angular panorama of a grid",
        ),
        (cube.without_poles(), Cut::Tile(32), "panorama"),
        (
            cube.without_poles(),
            Cut::Grid([4, 4]),
            "panorama of a grid",
        ),
        (
            cube.without_poles().for_two_eyes(),
            Cut::Tile(32),
            "two panoramas",
        ),
    ] {
        let scene = waves_on(surface, cut, 4, 2);
        for turn in [[0.0, 0.0, 0.0], [45.0, 44.0, 0.0], [135.0, -60.0, 20.0]] {
            for (across, size) in [(110.0, [120, 90]), (20.0, [90, 120])] {
                let view = of_right_eye(turned(turn, across, size));
                assert_alike(&scene, &view, 3, &format!("{name} {turn:?} {across}"));
            }
        }
    }
    let scene = waves_on(flat([190, 90]).for_two_eyes(), Cut::Tile(32), 4, 2);
    for (name, view) in plane_views(&scene.grid.surface) {
        assert_alike(
            &scene,
            &of_right_eye(view),
            3,
            &format!("two planes {name}"),
        );
    }
}

#[test]
fn a_sphere_is_drawn_as_by_its_twin() {
    for (size, cut, levels, ratio, name) in [
        ([256, 128], Cut::Tile(32), 4, 2, "pyramid"),
        ([250, 122], Cut::Tile(32), 4, 2, "odd pyramid"),
        ([240, 118], Cut::Grid([7, 4]), 3, 4, "grid"),
        ([96, 64], Cut::Tile(96), 3, 2, "one cell"),
    ] {
        let surface = Surface::equirect(size).for_two_eyes();
        let scene = waves_on(surface, cut, levels, ratio);
        for (n, turn) in [[179.0, 5.0, 15.0], [40.0, 88.0, 0.0], [-100.0, -90.0, 20.0]]
            .iter()
            .enumerate()
        {
            for (across, size) in [(110.0, [120, 90]), (15.0, [90, 120])] {
                let view = of_right_eye(turned(*turn, across, size));
                let what = format!("sphere {name} {turn:?} {across}");
                assert_alike(&scene, &view, n as u64, &what);
            }
        }
    }
}
