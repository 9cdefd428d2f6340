//! What is selection given of a viewer at one moment?

use crate::content::policy::Policy;
use crate::gaze::sample::{GazeSample, HeadPose};
use crate::perception::moment::Moment;
use crate::perception::parameters::EyeState;
use crate::units::Seconds;
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;

/// A gaze that moved less has not moved, in degrees.
const STILL_DEG: f64 = 0.05;

/// Where a viewer looks, and through what.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// Where the eye looks, in the space of the content.
    pub gaze: GazeSample,
    /// What is seen of the content.
    pub view: EyeView,
    /// Where the head is turned to.
    pub head: HeadPose,
    /// What the eye does.
    pub state: EyeState,
    /// How far the picture is behind the sound, where there is sound.
    pub behind_sound: Option<Seconds>,
}

impl Aim {
    /// The same, as far as it is chosen by.
    #[must_use]
    pub fn moment(&self) -> Moment {
        Moment {
            gaze: self.gaze,
            view: Some(self.view),
            state: self.state,
        }
    }

    /// Whether a policy that spends no budget could choose otherwise than for `before`.
    #[must_use]
    pub fn differs(&self, before: &Self, policy: Policy) -> bool {
        let moved = angle_between(self.gaze.gaze_in_content, before.gaze.gaze_in_content);
        let gaze_counts = !matches!(
            policy,
            Policy::Full | Policy::Coarsest | Policy::Viewport | Policy::Uniform
        );
        self.view != before.view || gaze_counts && moved.to_degrees() > STILL_DEG
    }
}
