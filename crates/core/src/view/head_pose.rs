//! Where is the head turned to?

use crate::units::Radians;
use crate::view::axes::Axes;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Orientation of the head in the content's space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeadPose {
    /// To the right.
    pub yaw: Radians,
    /// Up.
    pub pitch: Radians,
    /// Clockwise.
    pub roll: Radians,
}

impl HeadPose {
    /// The orientation as axes.
    #[must_use]
    pub fn axes(&self) -> Axes {
        Axes::from_yaw_pitch_roll(self.yaw, self.pitch, self.roll)
    }

    /// A direction given in the head's space (x right, y up, -z forward) in the content's.
    #[must_use]
    pub fn content_from_head(&self, direction_in_head: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = direction_in_head;
        let axes = self.axes();
        axes.right * x - axes.down * y - axes.forward * z
    }

    /// A direction given in the content's space in the head's; the inverse of
    /// [`Self::content_from_head`].
    #[must_use]
    pub fn head_from_content(&self, direction_in_content: DVec3) -> DVec3 {
        let axes = self.axes();
        DVec3::new(
            direction_in_content.dot(axes.right),
            -direction_in_content.dot(axes.down),
            -direction_in_content.dot(axes.forward),
        )
    }
}
