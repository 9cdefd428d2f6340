//! Which of the `foveal panels` commands runs?

mod fit;
mod map;
mod rig_args;
mod schema;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Panels {
    /// Where the source lies, and how many of its pixels are needed.
    Fit(fit::FitArgs),
    /// Where pixels of panels land in the source.
    Map(map::MapArgs),
    /// The JSON Schema of rig files.
    Schema(schema::SchemaArgs),
}

pub(crate) fn run(command: &Panels) -> anyhow::Result<()> {
    match command {
        Panels::Fit(args) => fit::run(args),
        Panels::Map(args) => map::run(args),
        Panels::Schema(args) => schema::run(args),
    }
}
