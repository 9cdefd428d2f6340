//! Does a tracker expect the same gaze, and find the same saccades, at any sampling rate?

use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::gaze::main_sequence::{saccade_duration, saccade_way};
use foveal_core::gaze::sample::{EyeEvent, GazeSample, HeadPose};
use foveal_core::gaze::tracker::GazeTracker;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::{angle_between, direction_between, direction_from_yaw_pitch};
use foveal_core::view::random::Random;
use glam::DVec3;

const FIXATION_S: f64 = 0.35;
const JUMPS: usize = 60;

/// A viewer who jumps from spot to spot while the head turns slowly.
struct Viewer {
    /// Times at which saccades begin, and where to, in the space of the head.
    jumps: Vec<(f64, DVec3)>,
}

impl Viewer {
    fn new() -> Self {
        let mut random = Random::new(11);
        let (mut time, mut at) = (0.0, DVec3::NEG_Z);
        let jumps = (0..=JUMPS).map(|k| {
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            let yaw = Radians::from_degrees(side * (3.0 + 7.0 * random.unit()));
            let to = direction_from_yaw_pitch(yaw, Radians::from_degrees(6.0 * random.unit()));
            let jump = (time, to);
            time += saccade_duration(angle_between(at, to)).0 + FIXATION_S;
            at = to;
            jump
        });
        let jumps = jumps.collect();
        Self { jumps }
    }

    fn head(time: f64) -> HeadPose {
        HeadPose {
            yaw: Radians::from_degrees(20.0 * libm::sin(0.7 * time)),
            ..HeadPose::default()
        }
    }

    fn gaze(&self, time: f64) -> DVec3 {
        let next = self.jumps.partition_point(|(begun, _)| *begun <= time);
        let (begun, to) = self.jumps[next - 1];
        let from = next
            .checked_sub(2)
            .map_or(DVec3::NEG_Z, |k| self.jumps[k].1);
        let angle = angle_between(from, to);
        let share = ((time - begun) / saccade_duration(angle).0).min(1.0);
        let in_head = direction_between(from, to, saccade_way(angle, share));
        Self::head(time).content_from_head(in_head)
    }

    /// What a tracker without noise, at this rate, expects in the middle of each fixation now and
    /// 50 ms later, and the number of saccades that it finds.
    fn watched(&self, rate_hz: f64) -> (Vec<[DVec3; 2]>, usize) {
        let mut tracker = GazeTracker::new(HeadGazePreset::free_viewing());
        let middles = self.jumps[1..]
            .iter()
            .map(|(begun, _)| begun - FIXATION_S / 2.0);
        let mut middles = middles.peekable();
        let (mut expected, mut found, mut jumping) = (Vec::new(), 0, false);
        for k in 0.. {
            let time = f64::from(k) / rate_hz;
            while let Some(middle) = middles.next_if(|middle| *middle < time) {
                let at = |ahead: f64| tracker.predict(Seconds(middle + ahead)).unwrap();
                expected.push([0.0, 0.05].map(|ahead| at(ahead).gaze.gaze_in_content));
            }
            if middles.peek().is_none() {
                return (expected, found);
            }
            let sample = GazeSample {
                gaze_in_content: self.gaze(time),
                spread: Radians::from_degrees(0.5),
                head: Some(Self::head(time)),
                ..GazeSample::at(Seconds(time), Radians(0.0), Radians(0.0))
            };
            tracker.push(&sample);
            let event = tracker.predict(Seconds(time)).unwrap().event;
            found += usize::from(event == EyeEvent::Saccade && !jumping);
            jumping = event == EyeEvent::Saccade;
        }
        unreachable!("there is always a later sample")
    }
}

#[test]
fn gaze_and_saccades_are_the_same_from_60_to_1000_hz() {
    let viewer = Viewer::new();
    let (finest, _) = viewer.watched(1000.0);
    for rate_hz in [60.0, 90.0, 120.0, 200.0, 250.0, 500.0, 1000.0] {
        let (expected, found) = viewer.watched(rate_hz);
        assert_eq!(expected.len(), JUMPS);
        let apart = expected
            .iter()
            .zip(&finest)
            .map(|(a, b)| [0, 1].map(|k| angle_between(a[k], b[k]).to_degrees()));
        let worst = apart.fold([0.0f64; 2], |most, now| [0, 1].map(|k| most[k].max(now[k])));
        eprintln!(
            "{rate_hz} Hz: {found} of {JUMPS} saccades, within {worst:.3?} degrees of 1000 Hz"
        );
        assert!(worst[0] < 0.5 && worst[1] < 1.0, "{rate_hz} Hz: {worst:?}");
        assert!(found.abs_diff(JUMPS) <= JUMPS / 20, "{rate_hz} Hz: {found}");
    }
}
