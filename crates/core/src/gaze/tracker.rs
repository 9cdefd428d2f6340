//! Where will the eye look when the picture is shown, and what does it do?
//!
//! Everything that is known of gaze meets here: samples are filtered, saccades found and their
//! landing predicted, the head's motion read, the head-only predictor adapted while there is a
//! true gaze to learn from, and for a later moment both blended by how old the gaze is.

use super::blend::blend;
use super::head_prediction::adaptive::AdaptiveHeadGaze;
use super::head_prediction::motion_from_poses::MotionFromPoses;
use super::head_prediction::saturating::HeadGazePreset;
use super::head_prediction::{GazeInHead, HeadMotion};
use super::landing::{USEFUL_AFTER, predict_landing};
use super::loss::HOLD;
use super::main_sequence::{saccade_duration, saccade_way};
use super::one_euro::GazeFilter;
use super::saccade::{Detection, SaccadeDetector};
use super::sample::{EyeEvent, GazeSample, HeadPose};
use super::spread::GazeEvidence;
use crate::units::{Radians, Seconds};
use crate::view::axes::{angle_between, direction_between};
use glam::DVec3;

/// Longest time that a head is carried on at its velocity; later it is taken to have stopped.
const LONGEST_TURN: Seconds = Seconds(0.3);
/// A head does not look steeper than this, in degrees.
const STEEPEST_DEG: f64 = 89.0;

/// What is expected of the eye at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Where it looks, with spread; `valid` says whether the eye itself was seen recently.
    pub gaze: GazeSample,
    /// What it does.
    pub event: EyeEvent,
    /// Time since the last saccade ended; nothing in one, or before the first.
    pub since_saccade: Option<Seconds>,
}

impl Prediction {
    /// An eye that looks there and stays.
    #[must_use]
    pub fn steady(gaze: GazeSample) -> Self {
        Self {
            gaze,
            event: EyeEvent::Fixation,
            since_saccade: None,
        }
    }
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
            (Some(seen), Some(_)) => self
                .landing(seen, time)
                .unwrap_or_else(|| self.blended(seen, time)),
            (Some(seen), None) => self.blended(seen, time),
            (None, _) => self.by_head_alone(newest, seen, time),
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

    /// How far the running saccade will be by `time`, once its landing can be predicted.
    fn landing(&self, seen: &GazeSample, time: Seconds) -> Option<GazeSample> {
        let saccade = self.detection.saccade?;
        if saccade.now.0 - saccade.onset.0 < USEFUL_AFTER.0 {
            return None;
        }
        let landing = predict_landing(&saccade);
        let amplitude = angle_between(saccade.from, landing.direction);
        let share = (time.0 - saccade.onset.0) / saccade_duration(amplitude).0;
        let behind = angle_between(saccade.from, saccade.at).0 / amplitude.0.max(1e-9);
        let way = saccade_way(amplitude, share.min(1.0)).clamp(behind.min(1.0), 1.0);
        let expected = direction_between(saccade.from, landing.direction, way);
        let own = (seen.spread.0 * seen.spread.0 + landing.spread.0 * landing.spread.0).sqrt();
        Some(GazeSample {
            gaze_in_content: self.content_from_head_at(expected, time),
            spread: Radians(own),
            ..*seen
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
    fn by_head_alone(
        &self,
        newest: &GazeSample,
        seen: Option<&GazeSample>,
        time: Seconds,
    ) -> GazeSample {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::direction_from_yaw_pitch;
    use crate::view::random::Random;

    const RATE_HZ: f64 = 120.0;

    fn tracker() -> GazeTracker {
        GazeTracker::new(HeadGazePreset::free_viewing())
    }

    fn direction(yaw_deg: f64, pitch_deg: f64) -> DVec3 {
        let degrees = Radians::from_degrees;
        direction_from_yaw_pitch(degrees(yaw_deg), degrees(pitch_deg))
    }

    fn sample(time: f64, gaze: DVec3, head_deg: Option<f64>) -> GazeSample {
        GazeSample {
            gaze_in_content: gaze,
            spread: Radians::from_degrees(1.0),
            head: head_deg.map(|yaw| HeadPose {
                yaw: Radians::from_degrees(yaw),
                ..HeadPose::default()
            }),
            ..GazeSample::at(Seconds(time), Radians(0.0), Radians(0.0))
        }
    }

    /// Fixations of 300 ms joined by saccades of 12° along the main sequence, with tracker noise.
    fn jumping_eye(rate_hz: f64, seconds: f64) -> Vec<(GazeSample, DVec3, bool)> {
        let mut random = Random::new(5);
        let amplitude = Radians::from_degrees(12.0);
        let duration = saccade_duration(amplitude).0;
        let period = 0.3 + duration;
        let spot = |k: i64| direction(if k % 2 == 0 { -6.0 } else { 6.0 }, 0.0);
        (0..(seconds * rate_hz) as usize)
            .map(|k| {
                let time = k as f64 / rate_hz;
                let turn = (time / period) as i64;
                let way = ((time - turn as f64 * period - 0.3) / duration).max(0.0);
                let share = saccade_way(amplitude, way);
                let truth = direction_between(spot(turn), spot(turn + 1), share);
                let noise = DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.0) * 1e-3;
                let seen = (truth + noise).normalize();
                (sample(time, seen, None), truth, way > 0.0)
            })
            .collect()
    }

    #[test]
    fn a_still_eye_is_expected_where_it_is_and_less_certainly_later() {
        let mut tracker = tracker();
        for k in 0..240 {
            tracker.push(&sample(
                f64::from(k) / RATE_HZ,
                direction(8.0, -3.0),
                Some(0.0),
            ));
        }
        let now = 239.0 / RATE_HZ;
        let at = |ahead: f64| tracker.predict(Seconds(now + ahead)).unwrap();
        let off = angle_between(at(0.01).gaze.gaze_in_content, direction(8.0, -3.0));
        assert!(off.to_degrees() < 0.05, "{off:?}");
        assert_eq!(at(0.0).event, EyeEvent::Fixation);
        let spreads = [0.0, 0.05, 0.1, 0.3].map(|ahead| at(ahead).gaze.spread.0);
        assert!(
            spreads.windows(2).all(|pair| pair[0] < pair[1]),
            "{spreads:?}"
        );
    }

    #[test]
    fn a_saccade_is_named_and_its_end_expected_before_it_is_there() {
        let mut tracker = tracker();
        let (mut named, mut ahead, mut current, mut told) = (0, 0.0, 0.0, 0);
        let samples = jumping_eye(500.0, 12.0);
        for (k, (sample, _, moving)) in samples.iter().enumerate() {
            tracker.push(sample);
            let expected = tracker.predict(Seconds(sample.time.0 + 0.03)).unwrap();
            named += usize::from(*moving && expected.event == EyeEvent::Saccade);
            let running = tracker.detection.saccade;
            let late =
                running.is_some_and(|s| (USEFUL_AFTER.0..0.03).contains(&(s.now.0 - s.onset.0)));
            if let (true, Some((_, truth, _))) = (*moving && late, samples.get(k + 15)) {
                ahead += angle_between(expected.gaze.gaze_in_content, *truth).to_degrees();
                current += angle_between(sample.gaze_in_content, *truth).to_degrees();
                told += 1;
            }
        }
        let moving = samples.iter().filter(|(_, _, moving)| *moving).count();
        assert!(named * 2 > moving, "{named} of {moving} samples");
        assert!(
            told > 50 && ahead < 0.8 * current,
            "{ahead} against {current} over {told}"
        );
    }

    #[test]
    fn a_lost_eye_holds_for_a_second_then_the_head_speaks() {
        let mut tracker = tracker();
        for k in 0..120 {
            tracker.push(&sample(
                f64::from(k) / RATE_HZ,
                direction(10.0, 0.0),
                Some(0.0),
            ));
        }
        let mut before = Radians(0.0);
        for k in 120..360 {
            let time = f64::from(k) / RATE_HZ;
            let lost = GazeSample {
                valid: false,
                ..sample(time, direction(0.0, 0.0), Some(60.0))
            };
            tracker.push(&lost);
            let expected = tracker.predict(Seconds(time)).unwrap();
            assert!(!expected.gaze.valid);
            let off_head = angle_between(expected.gaze.gaze_in_content, direction(60.0, 0.0));
            if time > 2.1 {
                assert!(off_head.to_degrees() < 8.0, "{time}: {off_head:?}");
            } else if time < 1.9 {
                assert!(expected.gaze.spread >= before, "{time}");
                before = expected.gaze.spread;
            }
        }
    }

    #[test]
    fn a_turning_head_is_not_taken_for_a_saccade_and_is_carried_on() {
        let mut tracker = tracker();
        for k in 0..240 {
            let time = f64::from(k) / RATE_HZ;
            let yaw = 120.0 * time;
            tracker.push(&sample(time, direction(yaw, 0.0), Some(yaw)));
            let expected = tracker.predict(Seconds(time)).unwrap();
            assert_ne!(expected.event, EyeEvent::Saccade, "{time}");
        }
        let now = 239.0 / RATE_HZ;
        let head = tracker.head_at(Seconds(now + 0.1)).unwrap();
        assert!((head.yaw.to_degrees() - 120.0 * (now + 0.1)).abs() < 1.0);
        let expected = tracker.predict(Seconds(now + 0.05)).unwrap().gaze;
        let off = angle_between(
            expected.gaze_in_content,
            direction(120.0 * (now + 0.05), 0.0),
        );
        assert!(off.to_degrees() < 3.0, "{off:?}");
    }

    #[test]
    fn mirrored_gaze_and_head_are_expected_mirrored() {
        let mut random = Random::new(9);
        let (mut left, mut right) = (tracker(), tracker());
        let mirrored = |d: DVec3| DVec3::new(-d.x, d.y, d.z);
        for k in 0..600 {
            let time = f64::from(k) / RATE_HZ;
            let yaw = 20.0 * (time * 1.7).sin();
            let gaze = direction(yaw + 6.0 * random.unit(), random.unit());
            left.push(&sample(time, gaze, Some(yaw)));
            right.push(&sample(time, mirrored(gaze), Some(-yaw)));
            let ahead = |tracker: &GazeTracker| tracker.predict(Seconds(time + 0.1)).unwrap();
            // What the preset says of a still head is a subject's habit, so it may lean.
            let off = angle_between(
                ahead(&left).gaze.gaze_in_content,
                mirrored(ahead(&right).gaze.gaze_in_content),
            );
            assert!(off.to_degrees() < 0.5, "{time}: {off:?}");
        }
    }

    #[test]
    fn nonsense_changes_nothing() {
        let mut tracker = tracker();
        assert!(tracker.predict(Seconds(0.0)).is_none());
        tracker.push(&sample(1.0, direction(3.0, 0.0), Some(0.0)));
        let before = tracker.predict(Seconds(1.0));
        for time in [f64::NAN, f64::INFINITY, 1.0, 0.5] {
            tracker.push(&sample(time, direction(90.0, 0.0), Some(50.0)));
        }
        assert_eq!(tracker.predict(Seconds(1.0)), before);
    }
}
