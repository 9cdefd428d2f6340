//! Which of the commands about gazes runs?

mod record;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum Gaze {
    /// Write what a source delivers to a trace.
    Record(record::RecordArgs),
}

pub(crate) fn run(command: &Gaze) -> anyhow::Result<()> {
    match command {
        Gaze::Record(args) => record::run(args),
    }
}
