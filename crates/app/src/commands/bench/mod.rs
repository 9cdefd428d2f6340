//! What does a part of Foveal cost on this machine?

mod equal_quality;
mod gpu;
mod perception;
mod prepare;
mod processor_time;
mod scene;
mod score;
mod video;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Bench {
    /// Time how steps are weighed, at 1920x1080 and five levels, against Fourier transforms.
    Perception(perception::PerceptionBenchArgs),
    /// Time a pack played foveated, against `viewport`, `full` and the original file.
    Video(video::VideoArgs),
    /// Time how video is prepared: source pixels a second, and bytes at equal quality.
    Prepare(prepare::PrepareBenchArgs),
    /// Time how foveated video of 1920x1080 at 30 frames a second is scored, against the clear
    /// text of the same equations.
    Score(score::ScoreBenchArgs),
    /// Measure a scene's bytes, speed and memory, each against a baseline.
    Scene(scene::SceneBenchArgs),
}

pub(crate) fn run(command: &Bench) -> anyhow::Result<()> {
    match command {
        Bench::Perception(args) => perception::run(args),
        Bench::Video(args) => video::run(args),
        Bench::Prepare(args) => prepare::run(args),
        Bench::Score(args) => score::run(args),
        Bench::Scene(args) => scene::run(args),
    }
}
