//! Which of the `foveal panels` commands runs?

mod bench;
mod comparing;
mod figures;
mod filter_name;
mod fit;
mod import;
mod map;
mod pattern;
pub(crate) mod rig_args;
mod schema;
pub(crate) mod warp;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Panels {
    /// Show where the source lies and how many of its pixels the panels need.
    Fit(fit::FitArgs),
    /// Show where pixels of panels land in the source.
    Map(map::MapArgs),
    /// Turn another program's file into a rig file.
    Import(import::ImportArgs),
    /// Fill all panels from one source.
    Warp(warp::args::WarpArgs),
    /// Measure what it costs to fill any number of panels.
    Bench(bench::PanelsBenchArgs),
    /// Draw the panels, their source and what pixels take of it.
    Figures(figures::FiguresArgs),
    /// Write a picture to line up panels by.
    Pattern(pattern::PatternArgs),
    /// Print the JSON Schema of rig files.
    Schema(schema::SchemaArgs),
}

pub(crate) fn run(command: &Panels) -> anyhow::Result<()> {
    match command {
        Panels::Fit(args) => fit::run(args),
        Panels::Map(args) => map::run(args),
        Panels::Import(args) => import::run(args),
        Panels::Warp(args) => warp::run(args),
        Panels::Bench(args) => bench::run(args),
        Panels::Figures(args) => figures::run(args),
        Panels::Pattern(args) => pattern::run(args),
        Panels::Schema(args) => schema::run(args),
    }
}
