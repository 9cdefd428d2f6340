//! Where is the head turned to?

use crate::units::Radians;
use crate::view::axes::{Axes, yaw_pitch_from_direction};
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

    /// The pose of a head with these axes.
    #[must_use]
    pub fn of(axes: &Axes) -> Self {
        let (yaw, pitch) = yaw_pitch_from_direction(axes.forward);
        let level = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
        let roll = axes.right.dot(level.down);
        let roll = libm::atan2(roll, axes.right.dot(level.right));
        Self {
            yaw,
            pitch,
            roll: Radians(roll),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_head_is_told_as_its_angles() {
        let head = HeadPose {
            yaw: Radians(0.3),
            pitch: Radians(-0.2),
            roll: Radians(0.1),
        };
        let told = HeadPose::of(&head.axes());
        for (told, is) in [
            (told.yaw, head.yaw),
            (told.pitch, head.pitch),
            (told.roll, head.roll),
        ] {
            assert!((told.0 - is.0).abs() < 1e-12);
        }
    }
}
