//! What is known about the eye at one moment?

use crate::units::{Radians, Seconds};
use crate::view::axes::direction_from_yaw_pitch;
pub use crate::view::head_pose::HeadPose;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// One gaze sample in the space of the content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazeSample {
    /// When the eye looked there, by the clock of the source.
    pub time: Seconds,
    /// When that was known here, by the same clock; never before `time` unless the clocks differ.
    pub received: Seconds,
    /// Unit direction in the content's space.
    pub gaze_in_content: DVec3,
    /// False while the eye is closed or lost; the direction is then the last one known.
    pub valid: bool,
    /// One standard deviation of the direction.
    pub spread: Radians,
    /// Orientation of the head, where it is known.
    pub head: Option<HeadPose>,
}

impl GazeSample {
    /// A certain gaze at a yaw and pitch of the content's forward.
    #[must_use]
    pub fn at(time: Seconds, yaw: Radians, pitch: Radians) -> Self {
        Self {
            time,
            received: time,
            gaze_in_content: direction_from_yaw_pitch(yaw, pitch),
            valid: true,
            spread: Radians(0.0),
            head: None,
        }
    }
}

/// What the eye does at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EyeEvent {
    /// Still, or following something.
    #[default]
    Fixation,
    /// Jumping.
    Saccade,
    /// Closed.
    Blink,
    /// Not seen by the tracker for longer than a blink lasts.
    Lost,
}
