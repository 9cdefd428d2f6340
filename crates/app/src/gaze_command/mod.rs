//! Which of the `foveal gaze` commands runs?

mod eval_delay;
mod eval_head;
mod fit;
mod record;
mod recordings;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(crate) enum GazeCommand {
    /// How true predictors and detectors are, against recordings.
    #[command(subcommand)]
    Eval(Eval),
    /// Make a preset from recordings.
    #[command(subcommand)]
    Fit(Fit),
    /// Write what a source delivers to a trace.
    Record(record::RecordArgs),
}

#[derive(Debug, Subcommand)]
pub(crate) enum Eval {
    /// Gaze from head motion: ours and the published models.
    Head(eval_head::EvalHeadArgs),
    /// A late gaze: the last one, the head's, and their blend.
    Delay(eval_delay::EvalDelayArgs),
}

#[derive(Debug, Subcommand)]
pub(crate) enum Fit {
    /// How gaze follows the head.
    Head(fit::FitHeadArgs),
}

pub(crate) fn run(command: &GazeCommand) -> anyhow::Result<()> {
    match command {
        GazeCommand::Eval(Eval::Head(args)) => eval_head::run(args),
        GazeCommand::Eval(Eval::Delay(args)) => eval_delay::run(args),
        GazeCommand::Fit(Fit::Head(args)) => fit::run(args),
        GazeCommand::Record(args) => record::run(args),
    }
}
