//! How long does a picture of 10,000 clusters at 1280x800 take?
//!
//! Prints the median of some frames, with and without the pass that leaves out what cannot be seen:
//! where all of it is seen, and where most of it lies outside the field of view.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::torus::{ALL, coming, coming_root, object, refinement, root, view};
use foveal_core::content::scene::description::SceneObject;
use foveal_core::view::eye_view::EyeView;
use foveal_render::{Culling, Gpu, RenderError, SceneLayer, SceneStyle};
use glam::{DAffine3, DVec3};
use std::time::Instant;

const SIZE: [u32; 2] = [1280, 800];
const FRAMES: usize = 9;
/// Tori along each side of a square: with 16 clusters each, 10,000.
const SIDE: u32 = 25;

fn main() -> Result<(), RenderError> {
    let gpu = Gpu::open_blocking()?;
    println!("{}", gpu.adapter_name());
    let standing = |k: u32| DVec3::new(f64::from(k % SIDE), 0.0, -f64::from(k / SIDE)) * 3.0;
    let placements = (0..SIDE * SIDE).map(|k| DAffine3::from_translation(standing(k)));
    let objects = [SceneObject {
        placements: placements.map(|it| it.to_cols_array()).collect(),
        ..object(ALL)
    }];
    let mut layer = SceneLayer::new(&gpu, &objects, &[], 16 << 20)?;
    let (root, fine) = (root(), refinement(&Vec::from_iter(0..16)));
    layer.upload(&coming_root(&root))?;
    layer.upload(&coming(1, &fine))?;
    let views = [
        ("all seen", view([36.0, 45.0, 35.0], [0.0, -40.0], SIZE)),
        ("from within", view([36.0, 2.0, -36.0], [30.0, -10.0], SIZE)),
    ];
    let outside = Culling {
        hidden: false,
        ..Culling::ALL
    };
    let ways = [
        ("all that is unseen left out", Culling::ALL),
        ("but not what is hidden", outside),
        ("nothing left out", Culling::NONE),
    ];
    for (name, view) in views {
        for (culled, culls) in ways {
            let style = SceneStyle {
                culls,
                ..SceneStyle::default()
            };
            let cpu = cpu_ms();
            let median = median_ms(&gpu, &mut layer, &view, &style)?;
            let cpu = (cpu_ms() - cpu) / FRAMES as f64;
            println!("{name}, {culled}: {median:.1} ms, {cpu:.0} ms of CPU time");
        }
    }
    println!("{} triangles", layer.triangles_drawn());
    Ok(())
}

/// CPU time of this process so far, where Linux reports it: a software GPU's true cost on a machine
/// that others use too.
fn cpu_ms() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after_name.split_whitespace().skip(11).take(2);
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() * 10.0
}

fn median_ms(
    gpu: &Gpu,
    layer: &mut SceneLayer,
    view: &EyeView,
    style: &SceneStyle,
) -> Result<f64, RenderError> {
    let mut times = Vec::new();
    for _ in 0..FRAMES {
        let start = Instant::now();
        layer.read(view, style)?.wait(gpu)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[FRAMES / 2])
}
