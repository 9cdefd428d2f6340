//! Where does the head point when only the gaze is known?
//!
//! A head follows the eyes: it turns towards the gaze with a lag, so that a saccade leaves the
//! centre of the view and the view then catches up. A stand-in for a recorded head, not a model.

use super::sample::HeadPose;
use crate::units::{Radians, Seconds};
use crate::view::axes::{direction_between, direction_from_yaw_pitch, yaw_pitch_from_direction};
use glam::DVec3;

/// Time in which a head covers 63 % of the way to the gaze, in seconds.
const LAG_S: f64 = 0.25;
/// A head does not look steeper than this, in degrees.
const STEEPEST_DEG: f64 = 80.0;

/// A head that follows a gaze.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FollowingHead {
    pose: Option<(Seconds, HeadPose)>,
}

impl FollowingHead {
    /// The head at `time`, when the eyes look along `gaze_in_content`; at first it faces the gaze.
    /// Times must not decrease.
    pub fn follow(&mut self, gaze_in_content: DVec3, time: Seconds) -> HeadPose {
        let target = facing(gaze_in_content);
        let pose = match self.pose {
            None => target,
            Some((before, pose)) => {
                let share = 1.0 - libm::exp(-(time.0 - before.0).max(0.0) / LAG_S);
                turned(pose, target, share)
            }
        };
        self.pose = Some((time, pose));
        pose
    }
}

fn facing(direction: DVec3) -> HeadPose {
    let (yaw, pitch) = yaw_pitch_from_direction(direction);
    let steepest = Radians::from_degrees(STEEPEST_DEG).0;
    HeadPose {
        yaw,
        pitch: Radians(pitch.0.clamp(-steepest, steepest)),
        roll: Radians(0.0),
    }
}

fn turned(from: HeadPose, to: HeadPose, share: f64) -> HeadPose {
    let [a, b] = [from, to].map(|pose| direction_from_yaw_pitch(pose.yaw, pose.pitch));
    facing(direction_between(a, b, share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_comes_to_face_a_steady_gaze_and_lags_behind_a_jump() {
        let at = |yaw: f64| direction_from_yaw_pitch(Radians(yaw), Radians(0.1));
        let mut head = FollowingHead::default();
        assert!(head.follow(at(0.0), Seconds(0.0)).yaw.0.abs() < 1e-12);
        let soon = head.follow(at(0.3), Seconds(0.04));
        assert!(soon.yaw.0 > 0.02 && soon.yaw.0 < 0.08, "{soon:?}");
        let late = head.follow(at(0.3), Seconds(5.0));
        assert!((late.yaw.0 - 0.3).abs() < 1e-6);
    }

    #[test]
    fn a_head_turns_the_short_way_round() {
        let at =
            |degrees: f64| direction_from_yaw_pitch(Radians::from_degrees(degrees), Radians(0.0));
        let mut head = FollowingHead::default();
        head.follow(at(170.0), Seconds(0.0));
        let yaw = head.follow(at(-170.0), Seconds(0.1)).yaw.to_degrees();
        assert!(yaw.abs() > 170.0, "{yaw}");
    }
}
