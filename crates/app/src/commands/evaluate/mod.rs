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
    /// A video under several codecs: time and bytes to prepare, speed to play.
    Codecs(codecs::CodecsArgs),
    /// A video cut into grids of 2x2 to 16x16 with 2 to 6 levels: pixels, speed, late frames.
    GridSweep(grid_sweep::GridSweepArgs),
    /// The score on pictures that come from formulas, against the published package's.
    Goldens(goldens::GoldensArgs),
    /// What --target asks for against what the judge finds, on generated scenes: the fit of the
    /// table that levels are chosen by, and how it holds elsewhere.
    Targets(targets::TargetsArgs),
    /// All policies on one pack over one gaze: pixels, bytes and time of each, and its score.
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
