//! Which question about the eye does `foveal perception` answer?

mod bands;
mod importance;
mod look;
mod sheet;
mod table;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Perception {
    /// Show what the eye resolves, and how little contrast it sees.
    Table(table::TableArgs),
    /// Show a picture's contrast, as one picture for each frequency band.
    Bands(bands::BandsArgs),
    /// Show what going from one picture to another is worth, as heat maps.
    Importance(importance::ImportanceArgs),
}

pub(crate) fn run(command: &Perception) -> anyhow::Result<()> {
    match command {
        Perception::Table(args) => table::run(args),
        Perception::Bands(args) => bands::run(args),
        Perception::Importance(args) => importance::run(args),
    }
}
