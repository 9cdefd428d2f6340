//! How near does a predicted landing come, how soon, and is it nearer than the eye itself?
//!
//! Time counts from the sample at which the detector first says saccade, for only then is there
//! something to predict. A saccade counts as long as the detector says that it runs.

use super::recording::{Label, Recording, Trial, saccades};
use super::saccade::detections;
use core::ops::Range;
use foveal_core::gaze::landing::predict_landing;
use foveal_core::gaze::saccade::{Detection, RunningSaccade};
use foveal_core::view::axes::angle_between;
use glam::DVec3;
use serde::Serialize;

/// How long after the detection landings are judged, in milliseconds.
pub const AFTER_MS: [f64; 5] = [8.0, 16.0, 20.0, 25.0, 30.0];
/// Amplitudes that are judged, in degrees: smaller ones are over before a prediction is of use,
/// larger ones are blinks or moves of the head.
const AMPLITUDE_DEG: [f64; 2] = [2.0, 30.0];

/// Errors some time after saccades were found, in degrees; `None` where none was running.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LandingScore {
    /// Milliseconds after the detection.
    pub ms: f64,
    /// Mean distance of the predicted landing from where the coder saw the saccade end.
    pub predicted_deg: Option<f64>,
    /// Mean distance of the newest sample from there.
    pub current_deg: Option<f64>,
    /// Saccades that were judged; not part of the record that is compared.
    #[serde(skip)]
    pub saccades: usize,
}

/// What the protocol finds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LandingReport {
    /// In the order of [`AFTER_MS`].
    pub after_ms: Vec<LandingScore>,
}

/// Runs detector and prediction over recordings and judges them by every coder.
#[must_use]
pub fn judge_landings(recordings: &[Recording]) -> LandingReport {
    let mut sums = [(0.0, 0.0, 0_usize); AFTER_MS.len()];
    for trial in recordings.iter().flat_map(|recording| &recording.trials) {
        let said = detections(trial);
        for (event, target) in trial
            .labels
            .iter()
            .flat_map(|labels| targets(trial, labels))
        {
            for (sum, after) in sums.iter_mut().zip(AFTER_MS) {
                if let Some(now) = later(trial, &said, &event, after) {
                    sum.0 += degrees(predict_landing(&now).direction, target);
                    sum.1 += degrees(now.at, target);
                    sum.2 += 1;
                }
            }
        }
    }
    let score = |((predicted, current, saccades), ms): ((f64, f64, usize), f64)| LandingScore {
        ms,
        predicted_deg: (saccades > 0).then(|| predicted / saccades as f64),
        current_deg: (saccades > 0).then(|| current / saccades as f64),
        saccades,
    };
    LandingReport {
        after_ms: sums.into_iter().zip(AFTER_MS).map(score).collect(),
    }
}

fn degrees(a: DVec3, b: DVec3) -> f64 {
    angle_between(a, b).to_degrees()
}

/// The saccades that a coder saw, seen by the tracker throughout, and where they landed.
fn targets(trial: &Trial, labels: &[Label]) -> Vec<(Range<usize>, DVec3)> {
    let samples = &trial.samples;
    let whole = |event: &Range<usize>| samples[event.clone()].iter().all(|sample| sample.valid);
    let target = |event: Range<usize>| {
        let target = samples[event.end - 1].gaze_in_content;
        let amplitude = degrees(samples[event.start].gaze_in_content, target);
        let judged = (AMPLITUDE_DEG[0]..=AMPLITUDE_DEG[1]).contains(&amplitude);
        judged.then_some((event, target))
    };
    saccades(labels)
        .into_iter()
        .filter(whole)
        .filter_map(target)
        .collect()
}

/// The saccade that was found in `event`, so long after it was found.
fn later(
    trial: &Trial,
    said: &[Detection],
    event: &Range<usize>,
    after_ms: f64,
) -> Option<RunningSaccade> {
    let first = |k: &usize| said[*k].saccade.is_some();
    let found = event.clone().find(first)?;
    let then = found + (after_ms * 1e-3 * trial.rate_hz).round() as usize;
    let now = said.get(then)?.saccade?;
    said[found]
        .saccade
        .filter(|saccade| saccade.found == now.found)
        .map(|_| now)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::synthetic::{SyntheticConfig, synthetic_recording};

    #[test]
    fn landings_are_nearer_than_the_eye_from_20_ms_on_and_get_nearer() {
        for rate_hz in [250.0, 500.0, 1000.0] {
            let config = SyntheticConfig {
                rate_hz,
                ..SyntheticConfig::default()
            };
            let report = judge_landings(&[synthetic_recording(&config)]);
            let scores = &report.after_ms[2..];
            for score in scores {
                assert!(
                    score.predicted_deg < score.current_deg,
                    "{score:?} at {rate_hz} Hz"
                );
                assert!(score.saccades > 20);
            }
            assert!(scores[2].predicted_deg < scores[0].predicted_deg);
        }
    }

    #[test]
    fn without_saccades_there_is_no_error_to_report() {
        let score = judge_landings(&[Recording::default()]).after_ms[0];
        assert_eq!((score.predicted_deg, score.saccades), (None, 0));
    }
}
