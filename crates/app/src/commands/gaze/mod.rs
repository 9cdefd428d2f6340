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
    /// Compare predictors and detectors with recordings.
    #[command(subcommand)]
    Eval(Eval),
    /// Fit a preset to recordings.
    #[command(subcommand)]
    Fit(Fit),
    /// Label every sample of a trace: fixation, saccade, blink or lost.
    Classify(classify::ClassifyArgs),
    /// Record a source of gaze as a trace.
    Record(record::RecordArgs),
}

#[derive(Debug, Subcommand)]
pub(crate) enum Eval {
    /// Predict gaze from head motion, by our model and the published ones.
    Head(eval_head::EvalHeadArgs),
    /// Predict a late gaze from the last one, from the head, and from both.
    Delay(eval_delay::EvalDelayArgs),
    /// Compare detected saccades with those that people labelled.
    Saccade(eval_events::EventArgs),
    /// Compare predicted landings of saccades with where they landed.
    Landing(eval_events::EventArgs),
    /// Check the 1 € filter against the published one, and measure how late it makes saccades.
    Filter(eval_events::EventArgs),
}

#[derive(Debug, Subcommand)]
pub(crate) enum Fit {
    /// Fit how gaze follows the head.
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
