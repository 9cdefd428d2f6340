//! How long does the value of every step take on the GPU, for 1920x1080 pixels in five levels?
//!
//! Prints the medians of the GPU's own time, where the adapter reports it, and of the time that a
//! caller waits.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::levels::{Content, levels, scattered};
use common::turned;
use foveal_core::perception::eye::Gaze;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::units::Radians;
use foveal_render::importance::{Importance, UnitIds, upload_picture};
use foveal_render::{Gpu, RenderError};
use std::time::{Duration, Instant};

const SIZE: [u32; 2] = [1920, 1080];
const LEVELS: usize = 5;
const RUNS: usize = 7;

fn median(mut times: Vec<Duration>) -> Option<Duration> {
    times.sort_unstable();
    times.get(times.len() / 2).copied()
}

fn main() -> Result<(), RenderError> {
    let gpu = Gpu::open_blocking()?;
    println!("{}", gpu.adapter_name());
    let view = turned([0.0; 3], 48.0, SIZE);
    let onlooker = Onlooker {
        view,
        gaze: Gaze {
            direction: view.axes.forward,
            spread: Radians::from_degrees(1.0),
        },
        state: EyeState::Steady,
    };
    let images = levels(Content::Natural, SIZE, LEVELS);
    let pictures: Vec<_> = images
        .iter()
        .map(|image| upload_picture(&gpu, image))
        .collect::<Result<_, _>>()?;
    let (ids, units) = scattered(SIZE, 64);
    let ids = UnitIds::upload(&gpu, SIZE, &ids, units)?;
    let mut importance = Importance::new(&gpu, SIZE, &Parameters::default())?;
    let pictures: Vec<_> = pictures.iter().collect();
    let (mut waited, mut on_gpu) = (Vec::new(), Vec::new());
    // The first run also makes what the driver makes late.
    importance.run(&pictures, &ids, &onlooker)?;
    for _ in 0..RUNS {
        let start = Instant::now();
        let gains = importance.run(&pictures, &ids, &onlooker)?;
        waited.push(start.elapsed());
        on_gpu.extend(gains.gpu_time);
    }
    let (waited, on_gpu) = (median(waited), median(on_gpu));
    println!("{SIZE:?}, {LEVELS} levels: waited {waited:?}, on the GPU {on_gpu:?}");
    Ok(())
}
