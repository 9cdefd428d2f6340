//! Which question about the eye does `foveal perception` answer?

mod bands;
mod importance;
mod look;
mod sheet;
mod table;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Perception {
    /// What the eye resolves, and how little contrast it sees.
    Table(table::TableArgs),
    /// A picture's contrast, one picture a frequency band.
    Bands(bands::BandsArgs),
    /// What going from one picture to another is worth, as heat maps.
    Importance(importance::ImportanceArgs),
}

pub(crate) fn run(command: &Perception) -> anyhow::Result<()> {
    match command {
        Perception::Table(args) => table::run(args),
        Perception::Bands(args) => bands::run(args),
        Perception::Importance(args) => importance::run(args),
    }
}
