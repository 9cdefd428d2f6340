//! How far is the eye, some time after it was last seen, from where it is expected?
//!
//! At each row three expectations are made for a later one, from what is known at the first: the
//! gaze itself, what the head says, and the blend of both.

use super::angle_statistics::mean;
use super::head_fit::HeadFit;
use super::head_recording::{HeadRecording, RATE_HZ};
use foveal_core::gaze::blend::blend;
use foveal_core::units::Seconds;
use serde::Serialize;

/// Delays of the protocol, in milliseconds.
pub const DELAYS_MS: [f64; 6] = [50.0, 100.0, 150.0, 200.0, 300.0, 500.0];

/// Mean errors after one delay, in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DelayErrors {
    /// The delay in milliseconds.
    pub delay_ms: f64,
    /// Of the last gaze.
    pub last_mean_deg: f64,
    /// Of the head alone.
    pub head_mean_deg: f64,
    /// Of the blend.
    pub blend_mean_deg: f64,
}

/// Mean errors after `delay_ms`, over all rows that have one so much later, with one fit per
/// recording; `None` where no recording is long enough. A delay counts in whole rows (10 ms).
///
/// # Panics
/// Unless there are as many fits as recordings.
#[must_use]
pub fn evaluate_delay(
    recordings: &[HeadRecording],
    fits: &[HeadFit],
    delay_ms: f64,
) -> Option<DelayErrors> {
    assert_eq!(recordings.len(), fits.len(), "one fit for each recording");
    let rows_later = (delay_ms * RATE_HZ / 1000.0).round() as usize;
    let age = Seconds(rows_later as f64 / RATE_HZ);
    let mut errors = [const { Vec::new() }; 3];
    for (recording, fit) in recordings.iter().zip(fits) {
        let rows = recording.rows();
        for (now, later) in rows.iter().zip(rows.iter().skip(rows_later)) {
            let head = fit.preset.predict(&now.head.motion);
            let expected = [now.gaze, head, blend(now.gaze, head, age)];
            for (errors, expected) in errors.iter_mut().zip(expected) {
                errors.push(expected.angle_to(later.gaze).to_degrees());
            }
        }
    }
    if errors[0].is_empty() {
        return None;
    }
    let [last, head, blend] = errors.map(|errors| mean(&errors));
    Some(DelayErrors {
        delay_ms,
        last_mean_deg: last,
        head_mean_deg: head,
        blend_mean_deg: blend,
    })
}

#[cfg(test)]
mod tests {
    use super::super::synthetic_viewer::viewer;
    use super::*;
    use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;

    fn errors(delay_ms: f64) -> Option<DelayErrors> {
        let law = HeadGazePreset::free_viewing();
        let recordings: Vec<HeadRecording> = (1..4).map(|seed| viewer(&law, 6.0, seed)).collect();
        let fits: Vec<HeadFit> = recordings
            .iter()
            .map(|_| HeadFit::shipped(law.clone()))
            .collect();
        evaluate_delay(&recordings, &fits, delay_ms)
    }

    #[test]
    fn without_delay_the_last_gaze_is_the_gaze() {
        let found = errors(0.0).unwrap();
        assert_eq!((found.last_mean_deg, found.blend_mean_deg), (0.0, 0.0));
        assert!(found.head_mean_deg > 3.0);
    }

    #[test]
    fn the_last_gaze_wins_early_the_head_late_and_the_blend_beats_the_head() {
        let [early, late] = [50.0, 500.0].map(|ms| errors(ms).unwrap());
        assert!(early.last_mean_deg < early.head_mean_deg, "{early:?}");
        assert!(late.head_mean_deg < late.last_mean_deg, "{late:?}");
        for found in [early, late] {
            assert!(
                found.blend_mean_deg < found.last_mean_deg.max(found.head_mean_deg),
                "{found:?}"
            );
        }
        assert!(late.last_mean_deg > early.last_mean_deg);
    }

    #[test]
    fn a_delay_longer_than_every_recording_has_no_result() {
        assert_eq!(errors(30_000.0), None);
        assert!(errors(29_990.0).is_some());
    }
}
