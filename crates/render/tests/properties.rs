//! Is the picture free of borders, and exact where nothing is missing?

use crate::common::*;
use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::picture::{Colour, Matrix, Picture};
use foveal_core::view::surface::{Eye, Mapping, Surface};
use foveal_render::{Gpu, RgbaImage, twin};

fn flat_scene(size: [u32; 2], cut: Cut, levels: u8, ratio: u32, colour: Colour) -> Scene {
    let grid = TileGrid::new(flat(size), cut, levels, ratio).unwrap();
    Scene::new(grid, colour, waves)
}

/// The textbook conversion, not rounded: chroma interpolated at its siting, then the matrix.
fn plainly(picture: &Picture, colour: Colour, [x, y]: [u32; 2]) -> [f64; 3] {
    let [kr, kb] = colour.matrix.luma_weights().map(f64::from);
    let full = colour.full_range;
    let luma = f64::from(picture.planes[0][(y * picture.width + x) as usize]);
    let [u, v] = [1, 2].map(|p| chroma(picture, p, [x, y], colour.chroma_left) - 128.0);
    let luma = if full {
        luma / 255.0
    } else {
        (luma - 16.0) / 219.0
    };
    let [u, v] = [u, v].map(|c| if full { c / 255.0 } else { c / 224.0 });
    let red = luma + 2.0 * (1.0 - kr) * v;
    let blue = luma + 2.0 * (1.0 - kb) * u;
    let green = (luma - kr * red - kb * blue) / (1.0 - kr - kb);
    [red, green, blue].map(|c| c.clamp(0.0, 1.0) * 255.0)
}

fn chroma(picture: &Picture, p: usize, [x, y]: [u32; 2], left: bool) -> f64 {
    let [columns, rows] = picture.plane_size(p);
    let at_x = f64::from(x) / 2.0 - if left { 0.0 } else { 0.25 };
    let at_y = f64::from(y) / 2.0 - 0.25;
    let sample = |i: f64, j: f64| {
        let i = i.clamp(0.0, f64::from(columns - 1)) as usize;
        let j = j.clamp(0.0, f64::from(rows - 1)) as usize;
        f64::from(picture.planes[p][j * columns as usize + i])
    };
    let (i, j) = (at_x.floor(), at_y.floor());
    let (s, t) = (at_x - i, at_y - j);
    let row = |j: f64| sample(i, j) * (1.0 - s) + sample(i + 1.0, j) * s;
    row(j) * (1.0 - t) + row(j + 1.0) * t
}

#[test]
fn all_fine_tiles_seen_one_to_one_are_the_plain_conversion() {
    let gpu = Gpu::open_blocking().unwrap();
    for colour in [FULL, LIMITED, LEFT] {
        for (size, cut, levels, ratio) in [
            ([320, 192], Cut::Tile(64), 4, 2),
            ([322, 186], Cut::Grid([5, 3]), 3, 4),
            ([64, 48], Cut::Tile(64), 1, 2),
        ] {
            let scene = flat_scene(size, cut, levels, ratio, colour);
            let mut renderer = scene.on_gpu(&gpu, &scene.finest());
            let view = EyeView::filling(&scene.grid.surface, size);
            let drawn = renderer.reconstruct(&view).unwrap();
            for at in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y])) {
                let (code, exact) = (drawn.pixel(at), plainly(&scene.faces[0], colour, at));
                for k in 0..3 {
                    // Rounded to the nearest code; a thousandth for the rounding of f32 before it.
                    let off = (f64::from(code[k]) - exact[k]).abs();
                    assert!(
                        off <= 0.501,
                        "{colour:?} {cut:?} {at:?}: {code:?}, {exact:?}"
                    );
                }
            }
        }
    }
}

/// Catmull and Rom 1974, as image libraries resize by it.
fn cubic(x: f64) -> f64 {
    match x.abs() {
        x if x < 1.0 => (1.5 * x - 2.5) * x * x + 1.0,
        x if x < 2.0 => ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0,
        _ => 0.0,
    }
}

#[test]
fn what_is_enlarged_twice_is_the_cubic_of_its_pixels_across_tiles_and_borders() {
    let gpu = Gpu::open_blocking().unwrap();
    for cut in [Cut::Tile(32), Cut::Grid([3, 2])] {
        let size = [96, 64];
        let grid = TileGrid::new(flat(size), cut, 3, 2).unwrap();
        // Grey, so that chroma, which is drawn in straight lines, says nothing.
        let scene = Scene::new(grid, FULL, |_, [x, y]| {
            let noise = (x * 12.9898 + y * 78.233).sin() * 43_758.545_3;
            [128.0 + 90.0 * (noise - noise.floor() - 0.5), 128.0, 128.0]
        });
        let view = EyeView::filling(&grid.surface, size.map(|side| 2 * side));
        let drawn = scene
            .on_gpu(&gpu, &scene.finest())
            .reconstruct(&view)
            .unwrap();
        let luma = |x: i64, y: i64| {
            let [x, y] = [x.clamp(0, 95), y.clamp(0, 63)];
            f64::from(scene.faces[0].planes[0][(y * 96 + x) as usize])
        };
        for y in 0..128 {
            for x in 0..192 {
                let place = [x, y].map(|k| (f64::from(k) + 0.5) / 2.0 - 0.5);
                let mut exact = 0.0;
                for row in -2..=2 {
                    for column in -2..=2 {
                        let at = [column, row].map(i64::from);
                        let at = [0, 1].map(|k| place[k].floor() as i64 + at[k]);
                        let weight = [0, 1].map(|k| cubic(place[k] - at[k] as f64));
                        exact += weight[0] * weight[1] * luma(at[0], at[1]);
                    }
                }
                let code = f64::from(drawn.pixel([x, y])[1]);
                let off = (code - exact.clamp(0.0, 255.0)).abs();
                assert!(off <= 0.51, "{cut:?} {x},{y}: {code} {exact}");
            }
        }
    }
}

#[test]
fn a_picture_of_one_colour_is_that_colour_everywhere() {
    let gpu = Gpu::open_blocking().unwrap();
    let colour = Colour {
        matrix: Matrix::Bt709,
        full_range: false,
        chroma_left: true,
    };
    let grids = [
        TileGrid::new(flat([283, 171]), Cut::Tile(32), 4, 2).unwrap(),
        TileGrid::new(flat([283, 171]), Cut::Grid([5, 3]), 3, 4).unwrap(),
        cube_waves(94, Cut::Grid([4, 4]), 3, 4).grid,
        cube_waves(100, Cut::Tile(32), 5, 2).grid,
        TileGrid::new(Surface::equirect([283, 171]), Cut::Tile(32), 4, 2).unwrap(),
    ];
    for grid in grids {
        let scene = Scene::new(grid, colour, |_, _| [101.0, 90.0, 160.0]);
        let mut renderer = scene.on_gpu(&gpu, &scene.some_tiles(3));
        for view in [
            turned([3.0, 2.0, 5.0], 12.0, [200, 150]),
            turned([42.0, 33.0, 9.0], 60.0, [200, 150]),
        ] {
            let image = renderer.reconstruct(&view).unwrap();
            let black = [0, 0, 0, 255];
            let shown: Vec<[u8; 4]> = (0..150)
                .flat_map(|y| (0..200).map(move |x| [x, y]))
                .map(|at| image.pixel(at))
                .filter(|&p| p != black)
                .collect();
            assert!(shown.iter().all(|p| p == &shown[0]), "{grid:?}");
        }
    }
}

#[test]
fn far_from_coarser_cells_the_picture_is_that_of_full_residency() {
    let gpu = Gpu::open_blocking().unwrap();
    for (cut, levels, ratio, cell) in [(Cut::Tile(64), 4, 2, 64), (Cut::Grid([6, 4]), 3, 2, 64)] {
        let scene = flat_scene([384, 256], cut, levels, ratio, FULL);
        let patch: Vec<Tile> = scene
            .grid
            .tiles_of(0)
            .filter(|t| (1..5).contains(&t.x) && (1..3).contains(&t.y))
            .collect();
        let view = EyeView::filling(&scene.grid.surface, [384, 256]);
        let some = scene.on_gpu(&gpu, &patch).reconstruct(&view).unwrap();
        let all = scene
            .on_gpu(&gpu, &scene.finest())
            .reconstruct(&view)
            .unwrap();
        // Growth of 4, or what fits a cell, times the rise to the coarsest level.
        let reach = (4 * (ratio.pow(u32::from(levels) - 1) - 1)).min(cell);
        for y in cell + reach..3 * cell - reach {
            for x in cell + reach..5 * cell - reach {
                assert_eq!(some.pixel([x, y]), all.pixel([x, y]), "{cut:?} at {x},{y}");
            }
        }
    }
}

/// Sum and number of differences between neighbouring pixels.
#[derive(Clone, Copy, Default)]
struct Steps(f64, u64);

impl Steps {
    fn add(&mut self, image: &RgbaImage, a: [u32; 2], b: [u32; 2]) {
        let (a, b) = (image.pixel(a), image.pixel(b));
        self.0 += (0..3).map(|k| f64::from(a[k].abs_diff(b[k]))).sum::<f64>();
        self.1 += 1;
    }

    fn mean(self) -> f64 {
        self.0 / self.1 as f64
    }
}

/// The steps straddling a line of the picture, and those `distances` pixels to both sides of it, at
/// the same pixels along the line: the two means are alike when there is no border.
///
/// Axis 0: a vertical line left of column `at`; axis 1: a horizontal line above row `at`.
fn straddle(
    image: &RgbaImage,
    axis: usize,
    at: u32,
    along: std::ops::Range<u32>,
    distances: &[u32],
) -> [Steps; 2] {
    let [mut across, mut beside] = [Steps::default(); 2];
    for l in along {
        let pixel = |a: u32| if axis == 0 { [a, l] } else { [l, a] };
        across.add(image, pixel(at - 1), pixel(at));
        for k in distances {
            beside.add(image, pixel(at - 1 - k), pixel(at - k));
            beside.add(image, pixel(at - 1 + k), pixel(at + k));
        }
    }
    [across, beside]
}

fn gather(all: &mut [Steps; 2], [across, beside]: [Steps; 2]) {
    for (sum, more) in all.iter_mut().zip([across, beside]) {
        *sum = Steps(sum.0 + more.0, sum.1 + more.1);
    }
}

fn assert_no_border([across, beside]: [Steps; 2], what: &str) {
    let ratio = across.mean() / beside.mean();
    println!("{what}: {ratio:.4} over {} pixels", across.1);
    assert!(
        across.1 > 100 && ratio <= 1.05,
        "{what}: steps at borders are {ratio} of others"
    );
}

/// Steps at all borders of cells: first those between cells of one level, then the others.
///
/// They are compared with steps a coarser chroma texel away, where the samples have the same
/// phase: linear interpolation has larger steps between two samples than across one, everywhere.
fn gather_borders(
    all: &mut [[Steps; 2]; 2],
    grid: &TileGrid,
    map: &[u32],
    image: &RgbaImage,
    cell: [u32; 2],
) {
    let [columns, rows] = grid.cells();
    let level = |x: u32, y: u32| map[(y * columns + x) as usize];
    let mut add = |axis, at, along, levels: [u32; 2]| {
        let texel = 2 * grid.scale(levels[0].max(levels[1]) as u8);
        if at > texel && at + texel < image.size[axis] {
            let steps = straddle(image, axis, at, along, &[texel]);
            gather(&mut all[usize::from(levels[0] != levels[1])], steps);
        }
    };
    for y in 0..rows {
        for x in 0..columns {
            let along = |k: usize, i: u32| i * cell[k]..((i + 1) * cell[k]).min(image.size[k]);
            if x > 0 {
                add(0, x * cell[0], along(1, y), [level(x - 1, y), level(x, y)]);
            }
            if y > 0 {
                add(1, y * cell[1], along(0, x), [level(x, y - 1), level(x, y)]);
            }
        }
    }
}

#[test]
fn no_border_shows_between_fine_and_coarse_tiles_on_a_plane() {
    let gpu = Gpu::open_blocking().unwrap();
    for (cut, levels, ratio, cell) in [
        (Cut::Tile(64), 4, 2, [64, 64]),
        (Cut::Tile(32), 5, 2, [32, 32]),
        (Cut::Grid([8, 5]), 3, 4, [64, 52]),
        (Cut::Grid([9, 7]), 3, 4, [58, 38]),
    ] {
        let grid = TileGrid::new(flat([512, 260]), cut, levels, ratio).unwrap();
        let view = EyeView::filling(&grid.surface, [512, 260]);
        let mut all = [[Steps::default(); 2]; 2];
        for pan in 0..24 {
            // The picture moves too, or its waves would meet every border in one phase.
            let pan = f64::from(pan);
            let scene = Scene::new(grid, FULL, |_, place| waves_moved(pan, place));
            let gaze = [120.0 + 12.0 * pan, 100.0 + 3.0 * pan];
            let tiles = fine_around(&grid, 0, gaze, [70.0, 20.0]);
            let mut renderer = scene.on_gpu(&gpu, &tiles);
            let image = renderer.reconstruct(&view).unwrap();
            let map = renderer.tiles().level_map();
            gather_borders(&mut all, &grid, &map, &image, cell);
        }
        assert_no_border(all[0], &format!("{cut:?}, same level"));
        assert_no_border(all[1], &format!("{cut:?}, unlike levels"));
    }
}

/// Views that look straight at an edge of the cube, which is then the middle column or row.
fn at_edges() -> Vec<(EyeView, usize)> {
    let size = [160, 160];
    let mut views: Vec<(EyeView, usize)> = [45.0, 135.0, -135.0, -45.0]
        .map(|yaw| (turned([yaw, 0.0, 0.0], 50.0, size), 0))
        .to_vec();
    for yaw in [0.0, 90.0, 180.0, -90.0] {
        for pitch in [45.0, -45.0] {
            views.push((turned([yaw, pitch, 0.0], 50.0, size), 1));
        }
    }
    views
}

#[test]
fn no_border_shows_at_the_edges_of_the_cube() {
    let gpu = Gpu::open_blocking().unwrap();
    for (face, mapping, cut, levels, ratio) in [
        (256, Mapping::Gnomonic, Cut::Tile(32), 4, 2),
        (250, Mapping::Gnomonic, Cut::Tile(32), 4, 2),
        (250, Mapping::Gnomonic, Cut::Grid([4, 4]), 3, 4),
        (256, Mapping::Gnomonic, Cut::Tile(64), 3, 2),
        (256, Mapping::EquiAngular, Cut::Tile(32), 4, 2),
        (250, Mapping::EquiAngular, Cut::Tile(64), 3, 2),
    ] {
        let surface = Surface::cube(face).mapped(mapping);
        let grid = TileGrid::new(surface, cut, levels, ratio).unwrap();
        let mut all = [Steps::default(); 2];
        let mut coarsest = [Steps::default(); 2];
        for (n, part) in [0.1, 0.35, 0.65, 0.97].into_iter().enumerate() {
            let scene = Scene::new(grid, FULL, |face, place| {
                waves_around_moved(n as f64, &surface, face, place)
            });
            let place = [f64::from(face) * part, f64::from(face) * (1.0 - part)];
            let tiles: Vec<Tile> = (0..6)
                .flat_map(|f| fine_around(&grid, f, place, [45.0, 15.0]))
                .collect();
            let [mut bare, mut mixed] = [scene.on_gpu(&gpu, &[]), scene.on_gpu(&gpu, &tiles)];
            for (view, axis) in at_edges() {
                let image = bare.reconstruct(&view).unwrap();
                gather(
                    &mut coarsest,
                    straddle(&image, axis, 80, 0..160, &[1, 2, 3]),
                );
                let image = mixed.reconstruct(&view).unwrap();
                gather(&mut all, straddle(&image, axis, 80, 0..160, &[1, 2, 3]));
            }
        }
        assert_no_border(coarsest, &format!("{face} {mapping:?} {cut:?} coarsest"));
        assert_no_border(all, &format!("{face} {mapping:?} {cut:?} mixed"));
    }
}

#[test]
fn a_cube_of_fine_tiles_shows_the_function_that_it_was_made_from() {
    for mapping in [Mapping::Gnomonic, Mapping::EquiAngular] {
        let scene = waves_on(Surface::cube(256).mapped(mapping), Cut::Tile(64), 3, 2);
        shows_its_waves(&scene);
    }
}

/// Views whose middle column or row runs along the seam of a sphere, or, looking at a pole, along
/// four meridians.
fn at_seams() -> Vec<(EyeView, usize)> {
    let size = [160, 160];
    let mut views: Vec<(EyeView, usize)> = [0.0, 40.0, -65.0]
        .map(|pitch| (turned([180.0, pitch, 0.0], 50.0, size), 0))
        .to_vec();
    for pitch in [90.0, -90.0] {
        let view = turned([0.0, pitch, 0.0], 50.0, size);
        views.extend([(view, 0), (view, 1)]);
    }
    views
}

#[test]
fn no_border_shows_at_the_seam_and_the_poles_of_a_sphere() {
    let gpu = Gpu::open_blocking().unwrap();
    for (size, cut, levels, ratio) in [
        ([1024, 512], Cut::Tile(64), 4, 2),
        ([1000, 500], Cut::Tile(64), 4, 2),
        ([1000, 500], Cut::Grid([8, 5]), 3, 4),
    ] {
        let surface = Surface::equirect(size);
        let grid = TileGrid::new(surface, cut, levels, ratio).unwrap();
        let (mut all, mut coarsest) = ([Steps::default(); 2], [Steps::default(); 2]);
        for (n, part) in [0.05, 0.4, 0.65, 0.97].into_iter().enumerate() {
            let scene = Scene::new(grid, FULL, |face, place| {
                waves_around_moved(n as f64, &surface, face, place)
            });
            let place = size.map(|side| f64::from(side) * part);
            let tiles = fine_around(&grid, 0, place, [150.0, 60.0]);
            let [mut bare, mut mixed] = [scene.on_gpu(&gpu, &[]), scene.on_gpu(&gpu, &tiles)];
            for (view, axis) in at_seams() {
                for (renderer, sums) in [(&mut bare, &mut coarsest), (&mut mixed, &mut all)] {
                    let image = renderer.reconstruct(&view).unwrap();
                    gather(sums, straddle(&image, axis, 80, 0..160, &[1, 2, 3]));
                }
            }
        }
        assert_no_border(coarsest, &format!("{size:?} {cut:?} coarsest"));
        assert_no_border(all, &format!("{size:?} {cut:?} mixed"));
    }
}

#[test]
fn a_sphere_of_fine_tiles_shows_the_function_that_it_was_made_from() {
    shows_its_waves(&waves_on(
        Surface::equirect([1024, 512]),
        Cut::Tile(64),
        3,
        2,
    ));
}

/// Every pixel of views over edges and corners is within four codes of the function.
fn shows_its_waves(scene: &Scene) {
    let gpu = Gpu::open_blocking().unwrap();
    let mut renderer = scene.on_gpu(&gpu, &scene.finest());
    let views = at_edges().into_iter().chain(at_seams());
    for view in views.map(|(view, _)| view).chain([
        turned([45.0, 35.26, 0.0], 50.0, [160, 160]),
        turned([-135.0, -35.26, 20.0], 50.0, [160, 160]),
    ]) {
        let image = renderer.reconstruct(&view).unwrap();
        for y in 0..160 {
            for x in 0..160 {
                let ray = view.ray([f64::from(x) + 0.5, f64::from(y) + 0.5]);
                let (face, place) = scene.grid.surface.locate(ray).unwrap();
                let [y_code, u, v] = waves_around(&scene.grid.surface, face, place);
                let (u, v) = (u - 128.0, v - 128.0);
                let blue = y_code + 2.0 * (1.0 - 0.0722) * u;
                let red = y_code + 2.0 * (1.0 - 0.2126) * v;
                let shown = image.pixel([x, y]);
                for (code, value) in [(shown[0], red), (shown[2], blue)] {
                    let off = (f64::from(code) - value.clamp(0.0, 255.0)).abs();
                    assert!(off <= 4.0, "{off} off at {x},{y}");
                }
            }
        }
    }
}

#[test]
fn each_eye_sees_its_own_content_as_if_there_were_no_other() {
    let gpu = Gpu::open_blocking().unwrap();
    for (surface, view) in [
        (
            Surface::cube(96),
            turned([45.0, 30.0, 10.0], 90.0, [90, 70]),
        ),
        (
            Surface::cube(96).without_poles(),
            turned([45.0, 30.0, 10.0], 90.0, [90, 70]),
        ),
        (
            Surface::equirect([200, 100]),
            turned([170.0, 60.0, 10.0], 90.0, [90, 70]),
        ),
        (
            flat([150, 90]),
            EyeView::filling(&flat([150, 90]), [120, 72]),
        ),
    ] {
        let both = waves_on(surface.for_two_eyes(), Cut::Tile(32), 3, 2);
        let tiles = both.some_tiles(9);
        let count = surface.faces() as usize;
        let mut drawn = both.on_gpu(&gpu, &tiles);
        for (eye, first) in [(Eye::Left, 0), (Eye::Right, count)] {
            let alone = Scene {
                grid: TileGrid::new(surface, Cut::Tile(32), 3, 2).unwrap(),
                colour: both.colour,
                faces: both.faces[first..first + count].to_vec(),
            };
            let its = tiles
                .iter()
                .filter(|tile| (first..first + count).contains(&usize::from(tile.face)));
            let own = |tile: &Tile| Tile {
                face: tile.face - first as u8,
                ..*tile
            };
            let its: Vec<Tile> = its.map(own).collect();
            let expected = alone.on_gpu(&gpu, &its).reconstruct(&view).unwrap();
            let seen = drawn.reconstruct(&EyeView { eye, ..view }).unwrap();
            assert_eq!(
                difference(&seen, &expected),
                (0, 0.0),
                "{surface:?} {eye:?}"
            );
            let other = twin::reconstruct(&alone.in_memory(&its), &of_right_eye(view));
            assert!(
                difference(&other, &expected).0 <= 3,
                "one picture serves both eyes"
            );
        }
    }
}

#[test]
fn a_panorama_is_black_where_it_has_no_face_and_as_a_cube_elsewhere() {
    let gpu = Gpu::open_blocking().unwrap();
    let whole = waves_on(Surface::cube(96), Cut::Tile(32), 3, 2);
    let ring = waves_on(Surface::cube(96).without_poles(), Cut::Tile(32), 3, 2);
    let view = turned([30.0, 40.0, 0.0], 100.0, [100, 80]);
    let expected = whole
        .on_gpu(&gpu, &whole.finest())
        .reconstruct(&view)
        .unwrap();
    let seen = ring
        .on_gpu(&gpu, &ring.finest())
        .reconstruct(&view)
        .unwrap();
    let (mut black, mut same) = (0, 0);
    for y in 0..80 {
        for x in 0..100 {
            let ray = view.ray([f64::from(x) + 0.5, f64::from(y) + 0.5]);
            match ring.grid.surface.locate(ray) {
                None => {
                    assert_eq!(seen.pixel([x, y]), [0, 0, 0, 255], "{x},{y}");
                    black += 1;
                }
                // Within two samples of a missing face borders repeat instead of going on.
                Some((_, place)) if (4.0..92.0).contains(&place[1]) => {
                    assert_eq!(seen.pixel([x, y]), expected.pixel([x, y]), "{x},{y}");
                    same += 1;
                }
                Some(_) => {}
            }
        }
    }
    assert!(black > 1000 && same > 1000, "{black} {same}");
}
