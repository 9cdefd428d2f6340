//! Which question about tiled displays does `foveal panels` answer?

mod bench;
mod comparing;
mod pattern;
mod sent;
mod warp;
mod warp_device;
mod warp_source;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum PanelsCommand {
    /// Fill all panels from one source.
    Warp(warp::WarpArgs),
    /// What it costs to fill any number of panels.
    Bench(bench::PanelsBenchArgs),
    /// Pictures to line up panels by.
    Pattern(pattern::PatternArgs),
}

pub(crate) fn run(command: &PanelsCommand) -> anyhow::Result<()> {
    match command {
        PanelsCommand::Warp(args) => warp::run(args),
        PanelsCommand::Bench(args) => bench::run(args),
        PanelsCommand::Pattern(args) => pattern::run(args),
    }
}
