//! What is a recording of a gaze that people have labelled?

use super::events::runs;
use core::ops::Range;
use foveal_core::gaze::sample::GazeSample;

/// What a coder saw a sample belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Label {
    /// Nothing that the coder would name.
    Undefined,
    /// An eye at rest.
    Fixation,
    /// A jump.
    Saccade,
    /// The swing after a jump (post-saccadic oscillation).
    Oscillation,
    /// An eye that follows something.
    Pursuit,
    /// A closed eye.
    Blink,
}

/// A stretch of samples without a break, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trial {
    /// Samples per second.
    pub rate_hz: f64,
    /// The samples; directions in the space of the head.
    pub samples: Vec<GazeSample>,
    /// For each coder, a label for each sample.
    pub labels: Vec<Vec<Label>>,
}

/// A labelled recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Its file, or what it was made from.
    pub name: String,
    /// Who labelled it.
    pub coders: Vec<String>,
    /// The detector restarts at each.
    pub trials: Vec<Trial>,
}

/// The saccades in a coder's labels.
#[must_use]
pub fn saccades(labels: &[Label]) -> Vec<Range<usize>> {
    let inside: Vec<bool> = labels
        .iter()
        .map(|&label| label == Label::Saccade)
        .collect();
    runs(&inside)
}
