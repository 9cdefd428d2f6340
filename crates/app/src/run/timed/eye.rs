//! Where does the eye of a measurement look?
//!
//! It jumps every ninth frame to anywhere on the content: harder than any viewer, as every jump
//! leaves all that was decoded near the gaze.

use foveal_core::gaze::head::FollowingHead;
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::tracker::Prediction;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::random::Random;
use foveal_core::view::surface::{Projection, Surface};
use foveal_play::WatchedFrame;
use glam::DVec3;

/// Frames from one saccade to the next: 300 ms of media of 30 frames a second.
pub(crate) const DWELL: u32 = 9;
/// What a good tracker is unsure of, in degrees.
const SPREAD_DEG: f64 = 0.5;

/// An eye that jumps, and the head that follows it on 360° content.
pub(crate) struct JumpingEye {
    surface: Surface,
    random: Random,
    head: FollowingHead,
    at: DVec3,
    frames: u32,
}

impl JumpingEye {
    pub(crate) fn new(surface: Surface, seed: u64) -> Self {
        Self {
            surface,
            random: Random::new(seed),
            head: FollowingHead::default(),
            at: DVec3::NEG_Z,
            frames: 0,
        }
    }

    /// The viewer of the next frame, which is shown at `time`.
    pub(crate) fn next(&mut self, time: Seconds) -> WatchedFrame {
        if self.frames.is_multiple_of(DWELL) {
            self.at = self.anywhere();
        }
        self.frames += 1;
        let head = match self.surface.projection {
            Projection::Flat => HeadPose::default(),
            Projection::Cube | Projection::Equirect => self.head.follow(self.at, time),
        };
        let gaze = GazeSample {
            time,
            received: time,
            gaze_in_content: self.at,
            valid: true,
            spread: Radians::from_degrees(SPREAD_DEG),
            head: Some(head),
        };
        WatchedFrame {
            gaze,
            gaze_is_known: true,
            head,
            expected: Prediction {
                gaze,
                event: EyeEvent::Fixation,
                since_saccade: None,
            },
            head_expected: head,
        }
    }

    fn anywhere(&mut self) -> DVec3 {
        match self.surface.projection {
            Projection::Cube | Projection::Equirect => self.random.direction(),
            Projection::Flat => {
                let place = self
                    .surface
                    .size
                    .map(|side| self.random.unit() * f64::from(side));
                self.surface.direction(0, place)
            }
        }
    }
}
