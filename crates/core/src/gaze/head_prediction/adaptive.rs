//! How does the head predictor become one viewer's own?
//!
//! Whenever the true gaze is known, gain, scale, linear part and offset of each axis move towards
//! the least sum of absolute errors, newer errors counting more. The recursion is Newton's on that
//! sum, rounded at its bend (Huber 1964), with a pull to the preset, so it is bounded however
//! little, or however oddly, the head moves.

use super::gaze_in_head::GazeInHead;
use super::motion::HeadMotion;
use super::saturating::{AxisCurve, HeadGazePreset, LINEAR_AT_DEG_S};
use crate::units::Seconds;
use glam::{DMat4, DVec4};

/// Time in which an error loses 63 % of its weight, in seconds.
const MEMORY_S: f64 = 60.0;
/// Most time that one sample stands for, in seconds: a gap is not evidence.
const LONGEST_STEP_S: f64 = 0.05;
/// Errors below this count by their square, so that the loss has a curvature; in degrees.
const BEND_DEG: f64 = 3.0;
/// How strongly the preset holds gain, logarithm of the scale, linear part and offset: as much as
/// this many seconds of errors of 1 degree.
const PULL_S: DVec4 = DVec4::splat(0.5);

/// A preset that learns. Fixed size: neither predicting nor observing allocates.
#[derive(Clone, Debug)]
pub struct AdaptiveHeadGaze {
    preset: HeadGazePreset,
    yaw: LearningCurve,
    pitch: LearningCurve,
    observed: Option<Seconds>,
}

impl AdaptiveHeadGaze {
    /// Begins as the preset.
    #[must_use]
    pub fn new(preset: HeadGazePreset) -> Self {
        Self {
            yaw: LearningCurve::new(preset.yaw),
            pitch: LearningCurve::new(preset.pitch),
            preset,
            observed: None,
        }
    }

    /// The preset as it is now.
    #[must_use]
    pub fn preset(&self) -> &HeadGazePreset {
        &self.preset
    }

    /// Where the eyes look for a head that moves so; see [`HeadGazePreset::predict`].
    #[must_use]
    pub fn predict(&self, motion: &HeadMotion) -> GazeInHead {
        self.preset.predict(motion)
    }

    /// Learns that the eyes looked at `gaze` while the head moved so. Samples that are not finite,
    /// or not newer than the last, are left out. What is learned does not depend on the rate.
    pub fn observe(&mut self, motion: &HeadMotion, gaze: GazeInHead) {
        let values = motion.velocity_deg_s.into_iter();
        let mut values = values
            .chain(motion.mean_acceleration_deg_s2)
            .chain(gaze.degrees());
        if !(motion.time.0.is_finite() && values.all(f64::is_finite)) {
            return;
        }
        let before = self.observed.replace(motion.time);
        let step_s = match before {
            Some(before) if motion.time.0 <= before.0 => {
                self.observed = Some(before);
                return;
            }
            Some(before) => (motion.time.0 - before.0).min(LONGEST_STEP_S),
            None => return,
        };
        let learned = |curve: &mut LearningCurve, axis: usize| {
            let drive = curve.now.drive(motion, axis);
            curve.observe(drive, gaze.degrees()[axis], step_s);
            curve.now
        };
        self.preset.yaw = learned(&mut self.yaw, 0);
        self.preset.pitch = learned(&mut self.pitch, 1);
    }
}

/// One axis: its curve, the curve it is pulled to, and how well the errors so far pin it down.
#[derive(Clone, Copy, Debug)]
struct LearningCurve {
    now: AxisCurve,
    preset: AxisCurve,
    information: DMat4,
}

impl LearningCurve {
    fn new(preset: AxisCurve) -> Self {
        Self {
            now: preset,
            preset,
            information: DMat4::ZERO,
        }
    }

    /// One Newton step of `sum of decayed |error| + pull`, whose gradient before this sample
    /// was zero: only this sample and the pull's lost share remain.
    fn observe(&mut self, drive: f64, gaze_deg: f64, step_s: f64) {
        let error = gaze_deg - self.now.gaze_deg(drive);
        // The loss is |error|, rounded below the bend; beyond it has a slope and no curvature.
        let downhill = step_s * (error / BEND_DEG).clamp(-1.0, 1.0);
        let curvature = if error.abs() < BEND_DEG {
            step_s / BEND_DEG
        } else {
            0.0
        };
        let decay = libm::exp(-step_s / MEMORY_S);
        let slope = slope(&self.now, drive);
        let outer = DMat4::from_cols(
            slope * slope.x,
            slope * slope.y,
            slope * slope.z,
            slope * slope.w,
        );
        self.information = self.information * decay + outer * curvature;
        let pull = PULL_S * (unknowns(&self.preset) - unknowns(&self.now)) * (1.0 - decay);
        let step =
            (self.information + DMat4::from_diagonal(PULL_S)).inverse() * (slope * downhill + pull);
        let moved = unknowns(&self.now) + step;
        set_unknowns(&mut self.now, moved);
    }
}

/// Gain, logarithm of the scale, linear part, offset.
fn unknowns(curve: &AxisCurve) -> DVec4 {
    DVec4::new(
        curve.gain_deg,
        libm::log(curve.scale_deg_s),
        curve.linear_deg,
        curve.offset_deg,
    )
}

/// Sets the unknowns, each held in its range.
fn set_unknowns(curve: &mut AxisCurve, to: DVec4) {
    let held = |k: usize, value: f64| {
        let [least, most] = AxisCurve::RANGES[k].1;
        value.clamp(least, most)
    };
    curve.gain_deg = held(0, to.x);
    curve.scale_deg_s = held(1, libm::exp(to.y));
    curve.linear_deg = held(2, to.z);
    curve.offset_deg = held(3, to.w);
}

/// Derivatives of the gaze by the unknowns.
fn slope(curve: &AxisCurve, drive: f64) -> DVec4 {
    let reduced = drive / curve.scale_deg_s;
    let tanh = libm::tanh(reduced);
    DVec4::new(
        tanh,
        -curve.gain_deg * reduced * (1.0 - tanh * tanh),
        drive / LINEAR_AT_DEG_S,
        1.0,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    /// Heads that turn to and fro at changing speeds, and eyes that follow `law` with noise.
    fn viewer(law: &HeadGazePreset, rate_hz: u32, seconds: u32) -> Vec<(HeadMotion, GazeInHead)> {
        let mut random = Random::new(11);
        let mut noise = [0.0; 2];
        (0..rate_hz * seconds)
            .map(|k| {
                let time = f64::from(k) / f64::from(rate_hz);
                let motion = HeadMotion {
                    time: Seconds(time),
                    velocity_deg_s: [45.0 * libm::sin(1.7 * time), 14.0 * libm::sin(2.3 * time)],
                    mean_acceleration_deg_s2: [0.0; 2],
                };
                if k % (rate_hz / 4) == 0 {
                    noise = [0, 1].map(|_| 12.0 * (random.unit() - random.unit()));
                }
                let gaze = law.predict(&motion).degrees();
                (
                    motion,
                    GazeInHead::within_reach([0, 1].map(|k| gaze[k] + noise[k])),
                )
            })
            .collect()
    }

    fn someone() -> HeadGazePreset {
        let mut law = HeadGazePreset::search();
        law.yaw.offset_deg = 3.0;
        law.pitch.offset_deg = -6.0;
        law
    }

    fn mean_deg(samples: &[(HeadMotion, GazeInHead)], preset: &HeadGazePreset) -> f64 {
        let angle = |(m, g): &(HeadMotion, GazeInHead)| preset.predict(m).angle_to(*g).to_degrees();
        samples.iter().map(angle).sum::<f64>() / samples.len() as f64
    }

    fn learned(samples: &[(HeadMotion, GazeInHead)]) -> HeadGazePreset {
        let mut adaptive = AdaptiveHeadGaze::new(HeadGazePreset::free_viewing());
        for (motion, gaze) in samples {
            adaptive.observe(motion, *gaze);
        }
        adaptive.preset().clone()
    }

    #[test]
    fn a_minute_of_true_gaze_teaches_most_of_another_law() {
        let samples = viewer(&someone(), 100, 120);
        let (taught, later) = samples.split_at(6000);
        let best = mean_deg(later, &someone());
        let before = mean_deg(later, &HeadGazePreset::free_viewing());
        let after = mean_deg(later, &learned(taught));
        assert!(before - best > 1.5, "{before} {best}");
        assert!(
            after - best < 0.1 * (before - best),
            "{before} {after} {best}"
        );
    }

    #[test]
    fn what_is_learned_does_not_depend_on_the_rate() {
        let at = |rate| learned(&viewer(&someone(), rate, 60));
        let reference = at(100);
        for rate in [60, 1000] {
            let found = at(rate);
            for (a, b) in [(found.yaw, reference.yaw), (found.pitch, reference.pitch)] {
                assert!(
                    (a.gain_deg - b.gain_deg).abs() < 0.5,
                    "{rate} Hz: {a:?} {b:?}"
                );
                assert!(
                    (a.offset_deg - b.offset_deg).abs() < 0.5,
                    "{rate} Hz: {a:?} {b:?}"
                );
            }
        }
    }

    #[test]
    fn nonsense_is_left_out_and_extremes_stay_in_range() {
        let mut adaptive = AdaptiveHeadGaze::new(HeadGazePreset::free_viewing());
        let mut random = Random::new(3);
        for k in 0..20_000 {
            let motion = HeadMotion {
                time: Seconds(f64::from(k) * 0.01),
                velocity_deg_s: [1e6 * (random.unit() - 0.5), 0.0],
                mean_acceleration_deg_s2: [1e9, -1e9],
            };
            let far = if k % 7 == 0 {
                f64::NAN
            } else {
                1e5 * (random.unit() - 0.5)
            };
            let gaze = GazeInHead {
                yaw_deg: far,
                pitch_deg: 80.0,
            };
            adaptive.observe(&motion, gaze);
        }
        assert!(adaptive.preset().clone().checked().is_ok(), "{adaptive:?}");
        let before = adaptive.preset().clone();
        let late = HeadMotion::default();
        adaptive.observe(&late, GazeInHead::CENTRE);
        assert_eq!(*adaptive.preset(), before);
    }

    #[test]
    fn without_evidence_a_viewer_returns_to_the_preset() {
        let mut adaptive = AdaptiveHeadGaze::new(HeadGazePreset::free_viewing());
        for (motion, gaze) in viewer(&someone(), 100, 60) {
            adaptive.observe(&motion, gaze);
        }
        let gained = adaptive.preset().yaw.gain_deg;
        for k in 0..60_000 {
            let time = Seconds(60.0 + f64::from(k) * 0.01);
            let still = HeadMotion {
                time,
                ..HeadMotion::default()
            };
            adaptive.observe(&still, adaptive.predict(&still));
        }
        let preset = HeadGazePreset::free_viewing().yaw.gain_deg;
        let left = adaptive.preset().yaw.gain_deg;
        assert!(
            (left - preset).abs() < 0.2 * (gained - preset).abs(),
            "{gained} {left}"
        );
    }
}
