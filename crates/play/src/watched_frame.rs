//! Where does a viewer look when a picture is shown?

use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::gaze::tracker::Prediction;

/// How a viewer is when a picture is shown, and what was known of that in time.
#[derive(Clone, Copy, Debug)]
pub struct WatchedFrame {
    /// Where the eye does look; where that is not known, what was expected.
    pub gaze: GazeSample,
    /// Whether where it does look is known: not of a live source, nor of a closed eye.
    pub gaze_is_known: bool,
    /// Where the head does point.
    pub head: HeadPose,
    /// What was expected of the eye.
    pub expected: Prediction,
    /// Where the head was expected.
    pub head_expected: HeadPose,
}

impl WatchedFrame {
    /// A viewer of whom everything is known in time: a steady eye.
    #[must_use]
    pub fn known(gaze: GazeSample, head: HeadPose) -> Self {
        Self {
            gaze,
            gaze_is_known: true,
            head,
            expected: Prediction::steady(gaze),
            head_expected: head,
        }
    }
}
