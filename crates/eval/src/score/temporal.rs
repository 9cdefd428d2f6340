//! Which frames of the last quarter of a second does an eye weigh how much?
//!
//! Mantiuk et al. 2021, temporal channels: a sustained channel that answers to what stays, and a
//! transient one, its derivative, that answers to what changes.

use super::constants::{SUSTAINED_PEAK_S, SUSTAINED_WIDTH, TRANSIENT_GAIN};
use super::rules::SamplingRule;

/// Keeps the logarithm of the time 0 finite, in seconds.
const TINY_S: f64 = 1e-4;
/// Taps a second of media: a window of 250 ms.
const WINDOWS_A_SECOND: f64 = 4.0;

/// Weights of the newest frame, the one before, and so on, for each channel: sustained, transient.
///
/// The sustained weights sum to 1 and that of the newest frame is next to nothing.
#[must_use]
pub fn taps(fps: f64, rule: SamplingRule) -> Vec<[f64; 2]> {
    assert!(fps > 0.0 && fps.is_finite(), "checked by Viewing::new");
    let count = ((fps / WINDOWS_A_SECOND).ceil() as usize).max(1);
    let step = match rule {
        SamplingRule::Widened => count as f64 / (fps * (count as f64 - 1.0).max(1.0)),
        SamplingRule::Frames => 1.0 / fps,
    };
    let raw: Vec<f64> = (0..count).map(|i| response(i as f64 * step)).collect();
    let sum: f64 = raw.iter().sum();
    let sustained: Vec<f64> = raw.iter().map(|weight| weight / sum).collect();
    let transient = |i: usize| match sustained.get(i + 1) {
        Some(next) => TRANSIENT_GAIN * (next - sustained[i]) / step,
        None => 0.0,
    };
    (0..count).map(|i| [sustained[i], transient(i)]).collect()
}

/// Sustained response to an impulse `time` seconds ago: a Gaussian of the logarithm of time.
fn response(time: f64) -> f64 {
    let octaves = ((time + TINY_S).ln() - SUSTAINED_PEAK_S.ln()) / SUSTAINED_WIDTH;
    (-octaves * octaves / 2.0).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_taps_of_30_frames_a_second_have_their_golden_weights() {
        let sustained = [
            0.0, 0.292294, 0.391627, 0.191150, 0.077159, 0.030398, 0.012250, 0.005121,
        ];
        let transient = [
            0.477017, 0.162110, -0.327174, -0.186031, -0.076312, -0.029617, -0.011634, 0.0,
        ];
        let found = taps(30.0, SamplingRule::Widened);
        assert_eq!(found.len(), 8);
        for (found, wanted) in found.iter().zip(sustained.into_iter().zip(transient)) {
            assert!((found[0] - wanted.0).abs() < 1e-6, "{found:?} {wanted:?}");
            assert!((found[1] - wanted.1).abs() < 1e-6, "{found:?} {wanted:?}");
        }
    }

    #[test]
    fn the_window_is_a_quarter_of_a_second_at_every_rate() {
        for (fps, count) in [(25.0, 7), (30.0, 8), (60.0, 15), (90.0, 23), (1.0, 1)] {
            for rule in [SamplingRule::Widened, SamplingRule::Frames] {
                let found = taps(fps, rule);
                assert_eq!(found.len(), count);
                let sum: f64 = found.iter().map(|weights| weights[0]).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{fps}: {sum}");
                assert!(found.iter().flatten().all(|weight| weight.is_finite()));
            }
        }
    }

    #[test]
    fn a_picture_that_stays_hardly_moves_the_transient_channel() {
        let sum: f64 = taps(30.0, SamplingRule::Widened)
            .iter()
            .map(|weights| weights[1])
            .sum();
        assert!((sum - 0.0084).abs() < 1e-4, "{sum}");
    }
}
