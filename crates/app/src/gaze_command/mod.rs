//! `foveal gaze`: what may be asked about gaze?

mod classify;
mod eval_events;
mod labelled_file;

use clap::Subcommand;

/// Questions about gaze.
#[derive(Debug, Subcommand)]
pub(crate) enum Gaze {
    /// How true detectors and predictors are, against labelled recordings.
    #[command(subcommand)]
    Eval(Eval),
    /// Label every sample of a trace: fixation, saccade, blink or lost.
    Classify(classify::ClassifyArgs),
}

/// Protocols.
#[derive(Debug, Subcommand)]
pub(crate) enum Eval {
    /// Saccades found, against those that people labelled.
    Saccade(eval_events::EventArgs),
    /// Predicted landings of saccades, against where they landed.
    Landing(eval_events::EventArgs),
    /// The 1 € filter: is it the published one, and how late does it make saccades.
    Filter(eval_events::EventArgs),
}

/// Runs a command.
pub(crate) fn run(command: &Gaze) -> anyhow::Result<()> {
    match command {
        Gaze::Eval(Eval::Saccade(args)) => eval_events::saccade(args),
        Gaze::Eval(Eval::Landing(args)) => eval_events::landing(args),
        Gaze::Eval(Eval::Filter(args)) => eval_events::filter(args),
        Gaze::Classify(args) => classify::run(args),
    }
}
