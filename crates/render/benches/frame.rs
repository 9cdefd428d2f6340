//! How long does a picture of 1280x720 take?
//!
//! Prints the median of some frames for a plane and a cube, with every tile fine, with a fine patch
//! in coarse surroundings, and with nothing but the coarsest level.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{FULL, Scene, turned, waves, waves_around};
use foveal_core::content::video::grid::tile_grid::{Cut, Tile, TileGrid};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Surface;
use foveal_render::{Gpu, HalvedBy, RadialBlur, RenderError};
use std::time::Instant;

const SIZE: [u32; 2] = [1280, 720];
const FRAMES: usize = 9;
/// Times that all tiles are uploaded.
const ROUNDS: usize = 30;

/// The tiles of the ring that `distance` (in cells from the middle of face 0) asks for.
fn foveated(grid: &TileGrid) -> Vec<Tile> {
    let [columns, rows] = grid.cells().map(f64::from);
    let mut wanted: Vec<Tile> = grid
        .tiles_of(0)
        .map(|cell| {
            let dx = (f64::from(cell.x) + 0.5 - columns / 2.0).abs() - 0.5;
            let dy = (f64::from(cell.y) + 0.5 - rows / 2.0).abs() - 0.5;
            let away = if cell.face == 0 {
                dx.max(dy).max(0.0)
            } else {
                9.0
            };
            let level = (away * 1.5) as u8;
            grid.tile_over(cell, level.min(grid.coarsest()))
        })
        .filter(|tile| tile.level < grid.coarsest())
        .collect();
    wanted.sort_unstable();
    wanted.dedup();
    wanted
}

/// CPU time of this process so far, where Linux reports it: a software GPU's true cost on a machine
/// that others use too.
fn cpu_ms() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2);
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() * 10.0
}

/// Prints what a tile costs on its way to the GPU, when there are some: until the calls
/// are back, and of the whole process until the GPU holds tiles and averages.
fn time_uploads(gpu: &Gpu, scene: &Scene, tiles: &[Tile]) -> Result<(), RenderError> {
    let pictures: Vec<_> = tiles.iter().map(|&tile| (tile, scene.tile(tile))).collect();
    if pictures.is_empty() {
        return Ok(());
    }
    for by in [HalvedBy::Cpu, HalvedBy::Gpu] {
        let mut renderer = scene.halved_by(by, gpu, tiles);
        renderer.tiles().settle()?;
        let (cpu, mut in_calls) = (cpu_ms(), 0.0);
        for _ in 0..ROUNDS {
            let start = Instant::now();
            for (tile, picture) in &pictures {
                renderer.tiles().upload(*tile, 1, picture)?;
            }
            in_calls += start.elapsed().as_secs_f64() * 1e3;
            renderer.tiles().settle()?;
        }
        let uploads = (ROUNDS * pictures.len()) as f64;
        let [calls, all] = [in_calls, cpu_ms() - cpu].map(|ms| ms / uploads);
        let count = pictures.len();
        println!("{count} uploads, averages by {by:?}: calls {calls:.3} ms each, CPU {all:.3}");
    }
    Ok(())
}

fn measure(gpu: &Gpu, scene: &Scene, view: &EyeView, name: &str) -> Result<(), RenderError> {
    for (kind, tiles) in [
        ("fine", scene.finest()),
        ("foveated", foveated(&scene.grid)),
        ("coarsest", Vec::new()),
    ] {
        let mut renderer = scene.on_gpu(gpu, &tiles);
        time_uploads(gpu, scene, &tiles)?;
        let mut times = Vec::new();
        renderer.reconstruct(view)?;
        let cpu = cpu_ms();
        for _ in 0..FRAMES {
            let start = Instant::now();
            renderer.reconstruct(view)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_by(f64::total_cmp);
        let bytes = renderer.tiles().gpu_bytes() as f64 / f64::from(1 << 20);
        let cpu = (cpu_ms() - cpu) / FRAMES as f64;
        let median = times[FRAMES / 2];
        println!("{name:20} {kind:10} {median:7.1} ms, CPU {cpu:7.1} ms, {bytes:5.1} MiB");
        if let Some(folder) =
            std::env::args().find_map(|a| a.strip_prefix("out=").map(String::from))
        {
            let path = std::path::Path::new(&folder).join(format!("{name} {kind}.png"));
            common::write_png(&path, &renderer.reconstruct(view)?);
        }
    }
    Ok(())
}

/// Prints what the blur costs on top of a picture.
fn time_blur(gpu: &Gpu, scene: &Scene, view: &EyeView, name: &str) -> Result<(), RenderError> {
    let mut renderer = scene.on_gpu(gpu, &foveated(&scene.grid));
    let gaze = view.ray(view.size.map(|side| f64::from(side) / 2.0));
    let mut each = |blur| -> Result<f64, RenderError> {
        renderer.radial_blur = blur;
        renderer.reconstruct(view)?;
        let cpu = cpu_ms();
        for _ in 0..FRAMES {
            renderer.reconstruct(view)?;
        }
        Ok((cpu_ms() - cpu) / FRAMES as f64)
    };
    let sharp = each(None)?;
    let blurred = each(Some(RadialBlur::round(gaze.normalize())))?;
    let more = (blurred / sharp - 1.0) * 100.0;
    println!("{name:20} blur: CPU {sharp:.1} ms to {blurred:.1} ms, {more:+.0} %");
    Ok(())
}

/// Prints what the twin needs for one picture.
fn time_twin(scene: &Scene, view: &EyeView) {
    let memory = scene.in_memory(&foveated(&scene.grid));
    let cpu = cpu_ms();
    let image = foveal_render::twin::reconstruct(&memory, view);
    println!(
        "twin, {} bytes: CPU {:.0} ms",
        image.pixels.len(),
        cpu_ms() - cpu
    );
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let gpu = Gpu::open_blocking()?;
    println!("{}", gpu.adapter_name());
    let flat = common::flat([2560, 1440]);
    let grid = TileGrid::new(flat, Cut::Tile(256), 5, 2)?;
    let plane = Scene::new(grid, FULL, waves);
    measure(
        &gpu,
        &plane,
        &EyeView::filling(&flat, SIZE),
        "plane minified 2x",
    )?;
    let middle = [640.0, 360.0];
    measure(
        &gpu,
        &plane,
        &common::window(&flat, middle, SIZE, 1.0),
        "plane 1 to 1",
    )?;
    let around = Surface::cube(2048);
    let grid = TileGrid::new(around, Cut::Tile(256), 5, 2)?;
    let cube = Scene::new(grid, FULL, |face, place| waves_around(&around, face, place));
    measure(
        &gpu,
        &cube,
        &turned([20.0, 10.0, 0.0], 90.0, SIZE),
        "cube 90 degrees",
    )?;
    measure(
        &gpu,
        &cube,
        &turned([5.0, 3.0, 0.0], 50.0, SIZE),
        "cube 50 degrees",
    )?;
    let one_to_one = common::window(&flat, middle, SIZE, 1.0);
    time_blur(&gpu, &plane, &one_to_one, "plane 1 to 1")?;
    time_blur(
        &gpu,
        &cube,
        &turned([20.0, 10.0, 0.0], 90.0, SIZE),
        "cube 90 degrees",
    )?;
    time_twin(&plane, &common::window(&flat, middle, SIZE, 1.0));
    time_twin(&cube, &turned([5.0, 3.0, 0.0], 50.0, SIZE));
    Ok(())
}
