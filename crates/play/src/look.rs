//! Where does a viewer look when a picture is shown?

use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::gaze::tracker::Prediction;

/// How a viewer is when a picture is shown, and what was known of that in time.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Where the eye does look; for a live source what was expected.
    pub gaze: GazeSample,
    /// Where the head does point.
    pub head: HeadPose,
    /// What was expected of the eye.
    pub expected: Prediction,
    /// Where the head was expected.
    pub head_expected: HeadPose,
}

impl Look {
    /// A viewer of whom everything is known in time: a steady eye.
    #[must_use]
    pub fn known(gaze: GazeSample, head: HeadPose) -> Self {
        Self {
            gaze,
            head,
            expected: Prediction::steady(gaze),
            head_expected: head,
        }
    }
}
