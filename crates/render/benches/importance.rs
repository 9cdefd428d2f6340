//! How long does the value of every step take on the GPU, for 1920x1080 pixels in five levels?
//!
//! Prints the medians of the GPU's own time, where the adapter tells it, and of the time that a
//! caller waits.
#![allow(clippy::print_stdout)]

use foveal_render::importance::Trial;
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
    let mut trial = Trial::new(&gpu, SIZE, LEVELS)?;
    let (mut waited, mut on_gpu) = (Vec::new(), Vec::new());
    // The first run also makes what the driver makes late.
    trial.run()?;
    for _ in 0..RUNS {
        let start = Instant::now();
        let gains = trial.run()?;
        waited.push(start.elapsed());
        on_gpu.extend(gains.gpu_time);
    }
    let (waited, on_gpu) = (median(waited), median(on_gpu));
    println!("{SIZE:?}, {LEVELS} levels: waited {waited:?}, on the GPU {on_gpu:?}");
    Ok(())
}
