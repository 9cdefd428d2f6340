//! Which of the `foveal gaze` commands runs?

mod classify;
mod eval_delay;
mod eval_events;
mod eval_head;
mod fit;
mod labelled_file;
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
    /// Label every sample of a trace: fixation, saccade, blink or lost.
    Classify(classify::ClassifyArgs),
    /// Write what a source delivers to a trace.
    Record(record::RecordArgs),
}

#[derive(Debug, Subcommand)]
pub(crate) enum Eval {
    /// Gaze from head motion: ours and the published models.
    Head(eval_head::EvalHeadArgs),
    /// A late gaze: the last one, the head's, and their blend.
    Delay(eval_delay::EvalDelayArgs),
    /// Saccades found, against those that people labelled.
    Saccade(eval_events::EventArgs),
    /// Predicted landings of saccades, against where they landed.
    Landing(eval_events::EventArgs),
    /// The 1 € filter: is it the published one, and how late does it make saccades.
    Filter(eval_events::EventArgs),
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
        GazeCommand::Eval(Eval::Saccade(args)) => eval_events::saccade(args),
        GazeCommand::Eval(Eval::Landing(args)) => eval_events::landing(args),
        GazeCommand::Eval(Eval::Filter(args)) => eval_events::filter(args),
        GazeCommand::Fit(Fit::Head(args)) => fit::run(args),
        GazeCommand::Classify(args) => classify::run(args),
        GazeCommand::Record(args) => record::run(args),
    }
}
