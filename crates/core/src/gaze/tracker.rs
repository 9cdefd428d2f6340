//! Where will the eye look when the picture is shown, and what does it do?
//!
//! Everything that is known of gaze meets here: samples are filtered, saccades found and their
//! landing predicted, the head's motion read, the head-only predictor adapted while there is a
//! true gaze to learn from, and for a later moment both blended by how old the gaze is.

use super::blend::blend;
use super::head_prediction::{
    AdaptiveHeadGaze, GazeInHead, HeadGazePreset, HeadMotion, MotionFromPoses,
};
use super::landing::{USEFUL_AFTER, predict_landing, saccade_duration};
use super::loss::HOLD;
use super::one_euro::GazeFilter;
use super::saccade::{Detection, SaccadeDetector};
use super::sample::{EyeEvent, GazeSample, HeadPose};
use super::spread::GazeEvidence;
use crate::units::{Radians, Seconds};
use crate::view::axes::angle_between;
use glam::DVec3;

/// Longest time that a head is carried on at its velocity; later it is taken to have stopped.
const LONGEST_TURN: Seconds = Seconds(0.3);
/// A head does not look steeper than this, in degrees.
const STEEPEST_DEG: f64 = 89.0;

/// What is expected of the eye at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Where it looks, with spread; `valid` tells whether the eye itself was seen lately.
    pub gaze: GazeSample,
    /// What it does.
    pub event: EyeEvent,
    /// Time since the last saccade ended; nothing in one, or before the first.
    pub since_saccade: Option<Seconds>,
}

/// Follows one viewer. Bounded memory, no allocation, some microseconds a sample.
#[derive(Clone, Debug)]
pub struct GazeTracker {
    filter: GazeFilter,
    detector: SaccadeDetector,
    motion_from_poses: MotionFromPoses,
    head_gaze: AdaptiveHeadGaze,
    /// The newest sample, as it came.
    newest: Option<GazeSample>,
    /// The newest sample that saw the eye, filtered.
    seen: Option<GazeSample>,
    detection: Detection,
    saccade_ended: Option<Seconds>,
    head: Option<(Seconds, HeadPose)>,
    motion: Option<HeadMotion>,
}

impl GazeTracker {
    /// A viewer of whom nothing is known yet but how their eyes go with their head.
    #[must_use]
    pub fn new(preset: HeadGazePreset) -> Self {
        Self {
            filter: GazeFilter::default(),
            detector: SaccadeDetector::default(),
            motion_from_poses: MotionFromPoses::default(),
            head_gaze: AdaptiveHeadGaze::new(preset),
            newest: None,
            seen: None,
            detection: Detection::default(),
            saccade_ended: None,
            head: None,
            motion: None,
        }
    }

    /// Takes the next sample. One that is not later than the one before changes nothing.
    pub fn push(&mut self, sample: &GazeSample) {
        let late = |newest: &GazeSample| sample.time.0 <= newest.time.0;
        if !sample.time.0.is_finite() || self.newest.as_ref().is_some_and(late) {
            return;
        }
        self.newest = Some(*sample);
        if let Some(head) = sample.head {
            self.head = Some((sample.time, head));
            self.motion = self.motion_from_poses.update(sample.time, &head);
        }
        // In the head's space a turning head is not mistaken for a moving eye.
        let in_head = self.head_from_content(sample.gaze_in_content);
        let before = self.detection;
        self.detection = self.detector.next(sample.time, in_head, sample.valid);
        if before.saccade.is_some() && self.detection.saccade.is_none() {
            self.saccade_ended = Some(sample.time);
        }
        if sample.valid {
            self.see(sample, in_head);
        }
    }

    fn see(&mut self, sample: &GazeSample, in_head: DVec3) {
        let steady = self.detection.event == EyeEvent::Fixation;
        let filtered = self.filter.next(sample.time, in_head, self.detection.event);
        // A source without spread has no noise to be filtered.
        let exact = sample.spread.0 <= 0.0;
        let in_head = if exact { in_head } else { filtered };
        if let (true, Some(motion)) = (steady, &self.motion)
            && let Some(gaze) = GazeInHead::from_direction_in_head(in_head)
        {
            self.head_gaze.observe(motion, gaze);
        }
        let content_from_head = |direction| match self.head {
            Some((_, head)) => head.content_from_head(direction),
            None => direction,
        };
        self.seen = Some(GazeSample {
            gaze_in_content: if exact {
                sample.gaze_in_content
            } else {
                content_from_head(in_head)
            },
            ..*sample
        });
    }

    fn head_from_content(&self, direction: DVec3) -> DVec3 {
        self.head
            .map_or(direction, |(_, head)| head.head_from_content(direction))
    }

    /// Where the head will point at `time`, carried on at its velocity; `None` where it is not
    /// known.
    #[must_use]
    pub fn head_at(&self, time: Seconds) -> Option<HeadPose> {
        let (at, head) = self.head?;
        let ahead = (time.0 - at.0).clamp(0.0, LONGEST_TURN.0);
        let [yaw, pitch] = self.motion.map_or([0.0; 2], |motion| motion.velocity_deg_s);
        let turned = |angle: Radians, deg_per_s: f64| {
            Radians(angle.0 + Radians::from_degrees(deg_per_s).0 * ahead)
        };
        let steepest = Radians::from_degrees(STEEPEST_DEG).0;
        let pitch = turned(head.pitch, pitch).0.clamp(-steepest, steepest);
        Some(HeadPose {
            yaw: turned(head.yaw, yaw),
            pitch: Radians(pitch),
            roll: head.roll,
        })
    }

    /// What to expect at `time`, from all samples so far; `None` before the first.
    #[must_use]
    pub fn predict(&self, time: Seconds) -> Option<Prediction> {
        let newest = self.newest.as_ref()?;
        let since_seen = |seen: &GazeSample| time.0 - seen.time.0;
        let seen = self.seen.as_ref();
        let held = seen.filter(|seen| newest.valid || since_seen(seen) <= HOLD.0);
        let gaze = match (held, self.detection.saccade) {
            (Some(seen), Some(_)) => self.landing(seen, time).unwrap_or_else(|| self.blended(seen, time)),
            (Some(seen), None) => self.blended(seen, time),
            (None, _) => self.from_head(newest, seen, time),
        };
        let running = self.detection.event == EyeEvent::Saccade;
        Some(Prediction {
            gaze: GazeSample {
                time,
                valid: newest.valid,
                head: self.head_at(time),
                ..gaze
            },
            event: self.detection.event,
            since_saccade: self
                .saccade_ended
                .filter(|_| !running)
                .map(|ended| Seconds(time.0 - ended.0)),
        })
    }

    /// The end of the running saccade, once it can be told and if it is over by `time`.
    fn landing(&self, seen: &GazeSample, time: Seconds) -> Option<GazeSample> {
        let saccade = self.detection.saccade?;
        if saccade.now.0 - saccade.onset.0 < USEFUL_AFTER.0 {
            return None;
        }
        let landing = predict_landing(&saccade);
        let amplitude = angle_between(saccade.from, landing.direction);
        let lands = saccade.onset.0 + saccade_duration(amplitude).0;
        (time.0 >= lands).then(|| {
            let own = (seen.spread.0 * seen.spread.0 + landing.spread.0 * landing.spread.0).sqrt();
            GazeSample {
                gaze_in_content: self.content_from_head_at(landing.direction, time),
                spread: Radians(own),
                ..*seen
            }
        })
    }

    fn content_from_head_at(&self, direction: DVec3, time: Seconds) -> DVec3 {
        self.head_at(time)
            .map_or(direction, |head| head.content_from_head(direction))
    }

    /// The last gaze and what the head says, by the age of the gaze.
    fn blended(&self, seen: &GazeSample, time: Seconds) -> GazeSample {
        let age = Seconds((time.0 - seen.time.0).max(0.0));
        if age.0 == 0.0 {
            return *seen;
        }
        let at_sight = seen.head.or(self.head.map(|(_, head)| head));
        let (Some(head), Some(motion)) = (at_sight, &self.motion) else {
            return GazeSample {
                spread: GazeEvidence::Tracker.spread(seen.spread, age),
                ..*seen
            };
        };
        let last = GazeInHead::from_direction_in_head(head.head_from_content(seen.gaze_in_content));
        let Some(last) = last else {
            return *seen;
        };
        let expected = blend(last, self.head_gaze.predict(motion), age);
        GazeSample {
            gaze_in_content: self.content_from_head_at(expected.direction_in_head(), time),
            spread: GazeEvidence::Blend.spread(seen.spread, age),
            ..*seen
        }
    }

    /// The head alone; without it what was seen last, ever less certain.
    fn from_head(&self, newest: &GazeSample, seen: Option<&GazeSample>, time: Seconds) -> GazeSample {
        let Some((at, _)) = self.head else {
            return super::loss::gaze_at(time, newest, seen);
        };
        let age = Seconds((time.0 - at.0).max(0.0));
        let expected = self
            .motion
            .map_or(GazeInHead::CENTRE, |motion| self.head_gaze.predict(&motion));
        let own = self.head_gaze.preset().spread();
        GazeSample {
            gaze_in_content: self.content_from_head_at(expected.direction_in_head(), time),
            spread: GazeEvidence::Head.spread(own, age),
            ..*newest
        }
    }
}
