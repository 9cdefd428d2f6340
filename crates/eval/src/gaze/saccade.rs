//! How well does a causal detector find the saccades that people see?

use super::events::Agreement;
use super::recording::{Label, Recording, Trial};
use super::velocity_rules::{engbert_kliegl, ivt_30};
use foveal_core::gaze::saccade::{Detection, FixedThreshold, SaccadeDetector};
use foveal_core::gaze::sample::{EyeEvent, GazeSample};
use serde::Serialize;

/// How well saccades were found. What nothing was there to say of is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SaccadeScore {
    /// Cohen's kappa over samples, saccade against anything else.
    pub kappa: Option<f64>,
    /// F1 over events, matched by largest overlap.
    pub event_f1: Option<f64>,
    /// Median of how long after the coder's onset the detector first said saccade.
    pub onset_lag_ms_median: Option<f64>,
    /// The lag that 90 % do not exceed.
    pub onset_lag_ms_p90: Option<f64>,
    /// Saccades that the coder does not have, per minute.
    pub false_events_per_minute: Option<f64>,
}

/// The score against one coder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CoderScore {
    /// Who labelled.
    pub coder: String,
    /// How well their saccades were found.
    #[serde(flatten)]
    pub score: SaccadeScore,
}

/// The score on one file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileScore {
    /// The file, or what was made in place of one.
    pub file: String,
    /// The mean over its coders.
    #[serde(flatten)]
    pub score: SaccadeScore,
    /// Against each.
    pub by_coder: Vec<CoderScore>,
}

/// What the protocol finds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SaccadeReport {
    /// Over all files: counted per coder, then the mean over coders.
    #[serde(flatten)]
    pub score: SaccadeScore,
    /// Each file by itself.
    pub by_file: Vec<FileScore>,
    /// The same over all files for the fixed threshold of Chen et al. 2022, sample by sample too.
    pub baseline_180: SaccadeScore,
    /// For Engbert and Kliegl 2003, which looks at whole trials.
    pub baseline_engbert_kliegl: SaccadeScore,
    /// For I-VT at 30° a second, which looks at what comes after a sample too.
    pub baseline_ivt_30: SaccadeScore,
}

/// Runs our detector and the baseline over recordings, sample by sample, restarted at each trial.
#[must_use]
pub fn judge_saccades(recordings: &[Recording]) -> SaccadeReport {
    let ours: Vec<_> = recordings.iter().map(|r| by_coder(r, detected)).collect();
    let baseline = |rule: Rule| {
        let all: Vec<_> = recordings.iter().map(|r| by_coder(r, rule)).collect();
        mean(&scores(&pooled(&all)))
    };
    SaccadeReport {
        score: mean(&scores(&pooled(&ours))),
        by_file: recordings
            .iter()
            .zip(&ours)
            .map(|(r, a)| file_score(r, a))
            .collect(),
        baseline_180: baseline(fixed_threshold),
        baseline_engbert_kliegl: baseline(engbert_kliegl),
        baseline_ivt_30: baseline(ivt_30),
    }
}

/// What our detector says of each sample of a trial.
pub(super) fn detections(trial: &Trial) -> Vec<Detection> {
    let mut detector = SaccadeDetector::default();
    let next = |s: &GazeSample| detector.next(s.time, s.gaze_in_content, s.valid);
    trial.samples.iter().map(next).collect()
}

/// Says of each sample of a trial whether it is in a saccade.
type Rule = fn(&Trial) -> Vec<bool>;

fn detected(trial: &Trial) -> Vec<bool> {
    let said = detections(trial).into_iter();
    said.map(|said| said.event == EyeEvent::Saccade).collect()
}

fn fixed_threshold(trial: &Trial) -> Vec<bool> {
    let mut rule = FixedThreshold::default();
    let next = |s: &GazeSample| rule.next(s.time, s.gaze_in_content, s.valid);
    let said = trial.samples.iter().map(next);
    said.map(|event| event == EyeEvent::Saccade).collect()
}

type ByCoder = Vec<(String, Agreement)>;

fn by_coder(recording: &Recording, rule: Rule) -> ByCoder {
    let mut all: ByCoder = recording
        .coders
        .iter()
        .map(|name| (name.clone(), Agreement::default()))
        .collect();
    for trial in &recording.trials {
        let predicted = rule(trial);
        for ((_, agreement), labels) in all.iter_mut().zip(&trial.labels) {
            let truly: Vec<bool> = labels.iter().map(|&l| l == Label::Saccade).collect();
            agreement.add(&truly, &predicted, trial.rate_hz);
        }
    }
    all
}

/// Counts of all files, coder by coder.
fn pooled(files: &[ByCoder]) -> ByCoder {
    let mut all = ByCoder::new();
    for (name, agreement) in files.iter().flatten() {
        match all.iter_mut().find(|(known, _)| known == name) {
            Some((_, sum)) => sum.merge(agreement),
            None => all.push((name.clone(), agreement.clone())),
        }
    }
    all
}

fn file_score(recording: &Recording, agreements: &ByCoder) -> FileScore {
    let scores = scores(agreements);
    FileScore {
        file: recording.name.clone(),
        score: mean(&scores),
        by_coder: scores,
    }
}

fn scores(agreements: &ByCoder) -> Vec<CoderScore> {
    let score = |(coder, a): &(String, Agreement)| CoderScore {
        coder: coder.clone(),
        score: SaccadeScore {
            kappa: a.kappa(),
            event_f1: a.event_f1(),
            onset_lag_ms_median: a.lag_ms(0.5),
            onset_lag_ms_p90: a.lag_ms(0.9),
            false_events_per_minute: a.false_events_per_minute(),
        },
    };
    agreements.iter().map(score).collect()
}

fn mean(scores: &[CoderScore]) -> SaccadeScore {
    let of = |value: fn(&SaccadeScore) -> Option<f64>| {
        let known: Vec<f64> = scores.iter().filter_map(|s| value(&s.score)).collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    };
    SaccadeScore {
        kappa: of(|s| s.kappa),
        event_f1: of(|s| s.event_f1),
        onset_lag_ms_median: of(|s| s.onset_lag_ms_median),
        onset_lag_ms_p90: of(|s| s.onset_lag_ms_p90),
        false_events_per_minute: of(|s| s.false_events_per_minute),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::synthetic::{SyntheticConfig, synthetic_recording};

    fn synthetic(config: SyntheticConfig) -> Recording {
        synthetic_recording(&config)
    }

    #[test]
    fn synthetic_saccades_are_found_in_noise_and_pursuit_at_every_rate() {
        // Rate, noise, pursuit, and what is demanded: F1 and median lag in milliseconds.
        for (rate_hz, noise_rms_deg, pursuit_deg_per_s, f1, lag_ms) in [
            (1000.0, 0.03, 0.0, 0.93, 8.0),
            (500.0, 0.02, 0.0, 0.93, 8.0),
            (500.0, 0.03, 15.0, 0.93, 8.0),
            (500.0, 0.10, 30.0, 0.90, 10.0),
            (200.0, 0.05, 20.0, 0.90, 10.0),
            (120.0, 0.05, 0.0, 0.90, 10.0),
            (90.0, 0.05, 0.0, 0.85, 12.0),
            (60.0, 0.05, 0.0, 0.75, 17.0),
        ] {
            let config = SyntheticConfig {
                rate_hz,
                noise_rms_deg,
                pursuit_deg_per_s,
                ..SyntheticConfig::default()
            };
            let score = judge_saccades(&[synthetic(config)]).score;
            assert!(score.event_f1.unwrap() >= f1, "{config:?}: {score:?}");
            assert!(
                score.onset_lag_ms_median.unwrap() <= lag_ms,
                "{config:?}: {score:?}"
            );
        }
    }

    #[test]
    fn the_fixed_threshold_misses_small_saccades_that_ours_finds() {
        let report = judge_saccades(&[synthetic(SyntheticConfig::default())]);
        assert!(report.baseline_180.event_f1 < report.score.event_f1);
        assert!(report.baseline_180.kappa < report.score.kappa);
    }

    #[test]
    fn rules_of_a_whole_trial_find_more_than_the_fixed_threshold() {
        let report = judge_saccades(&[synthetic(SyntheticConfig::default())]);
        let fixed = report.baseline_180.event_f1;
        assert!(
            report.baseline_engbert_kliegl.event_f1 > fixed,
            "{report:?}"
        );
        assert!(report.baseline_ivt_30.event_f1 > fixed, "{report:?}");
    }

    #[test]
    fn two_coders_are_scored_each_and_as_their_mean() {
        let mut recording = synthetic(SyntheticConfig {
            seconds: 30.0,
            ..Default::default()
        });
        recording.coders.push("blind".to_owned());
        let trial = &mut recording.trials[0];
        trial
            .labels
            .push(vec![Label::Fixation; trial.samples.len()]);
        let report = judge_saccades(&[recording.clone(), recording]);
        let file = &report.by_file[0];
        let f1: Vec<f64> = file
            .by_coder
            .iter()
            .filter_map(|c| c.score.event_f1)
            .collect();
        assert_eq!((file.by_coder[1].coder.as_str(), f1[1]), ("blind", 0.0));
        assert_eq!(file.score.event_f1, Some(f1[0] / 2.0));
        assert_eq!(
            report.score.event_f1, file.score.event_f1,
            "pooled over two equal files"
        );
    }
}
