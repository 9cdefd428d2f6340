//! Which experiment compares ways to prepare and to play a video, or judges the judge?

mod codecs;
mod goldens;
mod grid_sweep;
mod policies;
mod targets;
mod trial;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Evaluate {
    /// Compare codecs on a video: time and bytes to prepare, and speed to play.
    Codecs(codecs::CodecsArgs),
    /// Compare grids of 2x2 to 16x16 tiles with 2 to 6 levels: pixels, speed, late frames.
    GridSweep(grid_sweep::GridSweepArgs),
    /// Compare scores of pictures made from formulas with those of the published package.
    Goldens(goldens::GoldensArgs),
    /// Compare the scores that --target asks for with those that are reached.
    ///
    /// This fits the table by which levels are chosen on generated scenes, and checks it elsewhere.
    Targets(targets::TargetsArgs),
    /// Compare all policies on one pack: pixels, bytes, time and score of each.
    Policies(Box<policies::PoliciesArgs>),
}

pub(crate) fn run(command: &Evaluate) -> anyhow::Result<()> {
    match command {
        Evaluate::Codecs(args) => codecs::run(args),
        Evaluate::GridSweep(args) => grid_sweep::run(args),
        Evaluate::Goldens(args) => goldens::run(args),
        Evaluate::Targets(args) => targets::run(args),
        Evaluate::Policies(args) => policies::run(args),
    }
}
