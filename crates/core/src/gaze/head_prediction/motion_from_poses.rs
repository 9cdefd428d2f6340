//! How fast does a head turn that reports poses at any rate?
//!
//! Velocity is a difference over 10 ms or one interval between poses, whichever is longer; the
//! mean acceleration is that of two such velocities 20 ms or two intervals apart. Both windows are
//! times, not counts, so 60 Hz and 1000 Hz give the same motion.

use super::motion::HeadMotion;
use crate::gaze::sample::HeadPose;
use crate::units::{Radians, Seconds};
use crate::view::axes::Axes;
use glam::DVec3;

/// Shortest window of a velocity, in seconds.
const VELOCITY_S: f64 = 0.010;
/// Shortest time between the velocities of an acceleration, in seconds.
const ACCELERATION_S: f64 = 0.020;
/// Poses kept: 30 ms at 2000 Hz. Poses closer than that rate are left out.
const KEPT: usize = 64;
/// Least time between two kept poses, in seconds.
const CLOSEST_S: f64 = 0.0005;
/// After a silence of this many seconds a head's motion is unknown.
const SILENCE_S: f64 = 0.1;

/// Turns poses into motion. Fixed size: an update neither allocates nor looks at more than 64
/// poses.
#[derive(Clone, Copy, Debug)]
pub struct MotionFromPoses {
    /// Where the head pointed, in the content's space; a ring that ends before `next`.
    forward_in_content: [(f64, DVec3); KEPT],
    next: usize,
    count: usize,
}

impl Default for MotionFromPoses {
    fn default() -> Self {
        Self {
            forward_in_content: [(0.0, DVec3::NEG_Z); KEPT],
            next: 0,
            count: 0,
        }
    }
}

impl MotionFromPoses {
    /// The motion at `time`, as the head sees it: turns about its own up and right axes, so that
    /// roll, the poles and the seam of yaw make no difference.
    ///
    /// `None` until a second pose, and for a pose that is not finite, not newer than the last or
    /// less than 0.5 ms after it. Acceleration is 0 until its window is full. After a silence of
    /// 100 ms it starts over.
    pub fn update(&mut self, time: Seconds, pose: &HeadPose) -> Option<HeadMotion> {
        let axes = pose.axes();
        if !(time.0.is_finite() && axes.right.is_finite() && axes.down.is_finite()) {
            return None;
        }
        let interval = match self.newest() {
            Some((before, _)) if time.0 - before < CLOSEST_S => return None,
            Some((before, _)) if time.0 - before <= SILENCE_S => time.0 - before,
            _ => {
                self.count = 0;
                self.push(time.0, axes.forward);
                return None;
            }
        };
        self.push(time.0, axes.forward);
        let window = VELOCITY_S.max(interval);
        let apart = ACCELERATION_S.max(2.0 * interval);
        Some(self.motion(time, &axes, window, apart))
    }

    fn motion(&self, time: Seconds, axes: &Axes, window: f64, apart: f64) -> HeadMotion {
        let oldest = self.kept(self.count - 1).0;
        let window = window.min(time.0 - oldest);
        let velocity = self.mean_velocity(axes, time.0, window);
        let is_full = time.0 - apart - window >= oldest - 1e-9;
        let mean_acceleration_deg_s2 = if is_full {
            let before = self.mean_velocity(axes, time.0 - apart, window);
            [0, 1].map(|k| (velocity[k] - before[k]) / apart)
        } else {
            [0.0; 2]
        };
        // A difference is the velocity of its middle: half a window brings it to now.
        let velocity_deg_s =
            [0, 1].map(|k| velocity[k] + mean_acceleration_deg_s2[k] * window / 2.0);
        HeadMotion {
            time,
            velocity_deg_s,
            mean_acceleration_deg_s2,
        }
    }

    /// Mean velocity over the `window` that ends at `end`, seen from `axes`, in degrees a second.
    fn mean_velocity(&self, axes: &Axes, end: f64, window: f64) -> [f64; 2] {
        let [to, from] = [end, end - window].map(|time| angles_from(axes, self.forward_at(time)));
        [0, 1].map(|k| Radians(to[k] - from[k]).to_degrees() / window)
    }

    /// Where the head pointed, linear between kept poses.
    fn forward_at(&self, time: f64) -> DVec3 {
        let mut after = self.kept(0);
        for back in 0..self.count {
            let before = self.kept(back);
            if before.0 <= time {
                let span = after.0 - before.0;
                let share = if span > 0.0 {
                    (time - before.0) / span
                } else {
                    0.0
                };
                return before.1 + (after.1 - before.1) * share;
            }
            after = before;
        }
        after.1
    }

    /// The pose kept `back` poses ago; 0 is the newest.
    fn kept(&self, back: usize) -> (f64, DVec3) {
        self.forward_in_content[(self.next + KEPT - 1 - back) % KEPT]
    }

    fn newest(&self) -> Option<(f64, DVec3)> {
        (self.count > 0).then(|| self.kept(0))
    }

    fn push(&mut self, time: f64, forward_in_content: DVec3) {
        self.forward_in_content[self.next] = (time, forward_in_content);
        self.next = (self.next + 1) % KEPT;
        self.count = (self.count + 1).min(KEPT);
    }
}

/// How far right and up of the axes' forward a direction lies, in radians.
fn angles_from(axes: &Axes, direction: DVec3) -> [f64; 2] {
    let forward = direction.dot(axes.forward);
    [direction.dot(axes.right), -direction.dot(axes.down)]
        .map(|across| libm::atan2(across, forward))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::head_prediction::saturating::HeadGazePreset;

    fn pose(yaw_deg: f64, pitch_deg: f64, roll_deg: f64) -> HeadPose {
        let [yaw, pitch, roll] = [yaw_deg, pitch_deg, roll_deg].map(Radians::from_degrees);
        HeadPose { yaw, pitch, roll }
    }

    /// A head that sweeps 30° to both sides in 4 s and nods 5°: yaw, its velocity and acceleration.
    fn sweep(time: f64) -> [f64; 3] {
        let w = core::f64::consts::PI / 2.0;
        let (sin, cos) = (libm::sin(w * time), libm::cos(w * time));
        [30.0 * sin, 30.0 * w * cos, -30.0 * w * w * sin]
    }

    fn run(rate_hz: f64, mut each: impl FnMut(HeadMotion)) {
        let mut motion = MotionFromPoses::default();
        let count = (6.0 * rate_hz) as u32;
        for k in 0..=count {
            let time = f64::from(k) / rate_hz;
            let pose = pose(sweep(time)[0], 0.0, 0.0);
            if let Some(found) = motion.update(Seconds(time), &pose) {
                each(found);
            }
        }
    }

    #[test]
    fn every_rate_from_60_to_1000_hz_sees_the_same_motion() {
        for rate_hz in [60.0, 72.0, 90.0, 100.0, 120.0, 250.0, 500.0, 1000.0] {
            run(rate_hz, |found| {
                if found.time.0 < 0.1 {
                    return;
                }
                let [_, velocity, acceleration] = sweep(found.time.0);
                let late = 0.03 * 75.0 * 1.6;
                assert!(
                    (found.velocity_deg_s[0] - velocity).abs() < 0.15,
                    "{rate_hz} {found:?}"
                );
                let error = (found.mean_acceleration_deg_s2[0] - acceleration).abs();
                assert!(error < late, "{rate_hz} {found:?} {acceleration}");
                assert!(found.velocity_deg_s[1].abs() < 1e-6);
            });
        }
    }

    #[test]
    fn every_rate_from_60_to_1000_hz_predicts_the_same_gaze() {
        let preset = HeadGazePreset::free_viewing();
        let at_seconds = |rate_hz: f64| {
            let mut gazes = Vec::new();
            run(rate_hz, |found| {
                if (found.time.0 * 2.0 - libm::round(found.time.0 * 2.0)).abs() < 1e-9
                    && found.time.0 > 0.2
                {
                    gazes.push(preset.predict(&found));
                }
            });
            gazes
        };
        let reference = at_seconds(1000.0);
        assert_eq!(reference.len(), 12);
        for rate_hz in [60.0, 72.0, 90.0, 120.0, 500.0] {
            for (a, b) in reference.iter().zip(at_seconds(rate_hz)) {
                let apart = a.angle_to(b).to_degrees();
                assert!(apart < 0.25, "{rate_hz} Hz: {apart}");
            }
        }
    }

    #[test]
    fn the_seam_of_yaw_is_no_motion_and_roll_turns_what_right_means() {
        let mut motion = MotionFromPoses::default();
        motion.update(Seconds(0.0), &pose(179.9, 0.0, 0.0));
        let seam = motion
            .update(Seconds(0.01), &pose(-179.9, 0.0, 0.0))
            .unwrap();
        assert!((seam.velocity_deg_s[0] - 20.0).abs() < 1e-3, "{seam:?}");
        let mut motion = MotionFromPoses::default();
        motion.update(Seconds(0.0), &pose(0.0, 0.0, 90.0));
        let rolled = motion.update(Seconds(0.01), &pose(0.1, 0.0, 90.0)).unwrap();
        // With the right ear down, a turn to the right of the room is a turn up of the head.
        assert!(rolled.velocity_deg_s[0].abs() < 1e-3, "{rolled:?}");
        assert!((rolled.velocity_deg_s[1] - 10.0).abs() < 1e-3, "{rolled:?}");
    }

    #[test]
    fn bad_stamps_and_poses_are_left_out_and_silence_begins_anew() {
        let mut motion = MotionFromPoses::default();
        assert_eq!(motion.update(Seconds(f64::NAN), &pose(0.0, 0.0, 0.0)), None);
        assert_eq!(motion.update(Seconds(1.0), &pose(0.0, 0.0, 0.0)), None);
        assert_eq!(motion.update(Seconds(1.0), &pose(9.0, 0.0, 0.0)), None);
        assert_eq!(motion.update(Seconds(0.5), &pose(9.0, 0.0, 0.0)), None);
        assert_eq!(
            motion.update(Seconds(1.01), &pose(f64::NAN, 0.0, 0.0)),
            None
        );
        let next = motion.update(Seconds(1.01), &pose(0.1, 0.0, 0.0)).unwrap();
        assert!((next.velocity_deg_s[0] - 10.0).abs() < 1e-3);
        assert_eq!(motion.update(Seconds(2.0), &pose(90.0, 0.0, 0.0)), None);
    }
}
