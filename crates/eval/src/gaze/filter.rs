//! Is the filter the published one, and how late does it make a saccade?

use super::recording::{Recording, Trial, saccades};
use super::saccade::detections;
use core::ops::Range;
use foveal_core::gaze::one_euro::{GazeFilter, OneEuro, OneEuroConfig};
use foveal_core::gaze::saccade::Detection;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::units::Seconds;
use foveal_core::view::axes::angle_between;
use foveal_core::view::random::Random;
use glam::DVec3;
use serde::Serialize;

/// Saccades that lag is measured on, in degrees: smaller ones drown in noise.
const SMALLEST_DEG: f64 = 2.0;
/// Shares of a saccade's way at which raw and filtered gaze are compared.
const WAYS: [f64; 2] = [0.5, 0.9];
/// How long after a saccade a filtered gaze may still be on its way, in seconds.
const TAIL_S: f64 = 0.2;
/// Largest difference from the published algorithm.
const EXACT: f64 = 1e-12;

/// What the protocol finds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FilterReport {
    /// By how many samples the filter delays a saccade at half and at nine tenths of its way; the
    /// worst of all saccades, `None` without any.
    pub extra_lag_samples: Option<usize>,
    /// Whether the filter's results are those of Algorithm 1 of Casiez et al. 2012.
    pub conforms: bool,
}

/// Checks the filter, and its lag on the saccades that coders saw in recordings.
#[must_use]
pub fn judge_filter(recordings: &[Recording]) -> FilterReport {
    let trials = recordings.iter().flat_map(|recording| &recording.trials);
    FilterReport {
        extra_lag_samples: trials.filter_map(worst_lag).max(),
        conforms: conforms(),
    }
}

/// The worst lag of a trial's saccades, by every coder.
fn worst_lag(trial: &Trial) -> Option<usize> {
    let raw: Vec<DVec3> = trial
        .samples
        .iter()
        .map(|sample| sample.gaze_in_content)
        .collect();
    let mut filter = GazeFilter::default();
    let steady =
        |(said, s): (Detection, &GazeSample)| filter.next(s.time, s.gaze_in_content, said.event);
    let said = detections(trial).into_iter();
    let filtered: Vec<DVec3> = said.zip(&trial.samples).map(steady).collect();
    let tail = (TAIL_S * trial.rate_hz) as usize;
    let mut worst = None;
    for labels in &trial.labels {
        let events = saccades(labels);
        for (k, event) in events.iter().enumerate() {
            let next = events.get(k + 1).map_or(raw.len(), |next| next.start);
            let seen = event.start..next.min(event.end + tail);
            if trial.samples[seen.clone()]
                .iter()
                .all(|sample| sample.valid)
            {
                worst = worst.max(lag(&raw, &filtered, event, seen.end));
            }
        }
    }
    worst
}

/// By how many samples `filtered` comes later than `raw` past [`WAYS`] of a saccade, until
/// `limit`; `None` for a saccade too small to measure.
fn lag(raw: &[DVec3], filtered: &[DVec3], event: &Range<usize>, limit: usize) -> Option<usize> {
    let (from, to) = (raw[event.start], raw[event.end - 1]);
    if angle_between(from, to).to_degrees() < SMALLEST_DEG {
        return None;
    }
    let along = (to - from) / (to - from).length_squared();
    let passes = |gaze: &[DVec3], way: f64| {
        let passed = gaze[event.start..limit]
            .iter()
            .position(|&at| (at - from).dot(along) >= way);
        passed.unwrap_or(limit - event.start)
    };
    let lag = |way: f64| passes(filtered, way).saturating_sub(passes(raw, way));
    WAYS.map(lag).into_iter().max()
}

/// Algorithm 1 of Casiez et al. 2012 as printed, of one number: the oracle.
#[derive(Default)]
struct AsPrinted {
    x_hat_prev: Option<f64>,
    dx_hat_prev: f64,
}

impl AsPrinted {
    fn filter(&mut self, x: f64, rate: f64, config: &OneEuroConfig) -> f64 {
        let alpha = |cutoff: f64| {
            let tau = 1.0 / (2.0 * std::f64::consts::PI * cutoff);
            let te = 1.0 / rate;
            1.0 / (1.0 + tau / te)
        };
        let Some(x_hat_prev) = self.x_hat_prev else {
            self.x_hat_prev = Some(x);
            return x;
        };
        let dx = (x - x_hat_prev) * rate;
        let a = alpha(config.speed_cutoff_hz);
        self.dx_hat_prev = a * dx + (1.0 - a) * self.dx_hat_prev;
        let a = alpha(config.min_cutoff_hz + config.beta * self.dx_hat_prev.abs());
        let x_hat = a * x + (1.0 - a) * x_hat_prev;
        self.x_hat_prev = Some(x_hat);
        x_hat
    }
}

/// Whether the filter gives what the oracle gives, on noisy waves at an uneven rate.
fn conforms() -> bool {
    let published = OneEuroConfig {
        min_cutoff_hz: 1.0,
        beta: 0.1,
        speed_cutoff_hz: 1.0,
    };
    [published, OneEuroConfig::default()].iter().all(|config| {
        let (mut ours, mut printed) = (OneEuro::new(*config), AsPrinted::default());
        let (mut random, mut time) = (Random::new(1), 0.0);
        (0..5000).all(|_| {
            let before = time;
            time += 0.001 + 0.02 * random.unit();
            let x = f64::sin(time) + 0.2 * random.unit();
            let expected = printed.filter(x, 1.0 / (time - before), config);
            let got = ours.next(Seconds(time), DVec3::new(x, 0.0, 0.0));
            (got.x - expected).abs() <= EXACT
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::synthetic::{SyntheticConfig, synthetic_recording};
    use foveal_core::units::Radians;

    #[test]
    fn the_filter_is_the_published_one_and_delays_saccades_by_one_sample_at_most() {
        for rate_hz in [120.0, 250.0, 500.0, 1000.0] {
            let config = SyntheticConfig {
                rate_hz,
                ..SyntheticConfig::default()
            };
            let report = judge_filter(&[synthetic_recording(&config)]);
            assert!(report.conforms);
            assert!(
                report.extra_lag_samples.unwrap() <= 1,
                "{report:?} at {rate_hz} Hz"
            );
        }
    }

    #[test]
    fn lag_is_the_samples_between_the_two() {
        let at = |k: usize, late: usize| {
            let yaw = 0.02 * (k.saturating_sub(10 + late)).min(10) as f64;
            GazeSample::at(Seconds(0.0), Radians(yaw), Radians(0.0)).gaze_in_content
        };
        let gaze = |late| (0..60).map(|k| at(k, late)).collect::<Vec<_>>();
        for late in [0, 1, 3, 7] {
            assert_eq!(lag(&gaze(0), &gaze(late), &(10..21), 60), Some(late));
        }
        assert_eq!(lag(&gaze(0), &gaze(99), &(10..21), 60), Some(45));
        assert_eq!(lag(&gaze(0), &gaze(0), &(0..9), 60), None);
    }
}
