//! How far from the true gaze is each predictor that sees only the head?
//!
//! Rows stream in the order of time; a predictor sees what came before and the row itself. Errors
//! are angles between directions, over all rows.

use super::angle_statistics::{AngleStatistics, mean};
use super::head_fit::{HeadFit, fit_head};
use super::head_recording::{HeadRecording, HeadRow};
use foveal_core::gaze::head_prediction::GazeInHead;
use foveal_core::gaze::head_prediction::lu_2020::predict_lu_2020;
use foveal_core::gaze::head_prediction::sgaze::Sgaze;
use serde::Serialize;

/// One value per predictor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ByPredictor<T> {
    /// Straight ahead, always.
    pub centre: T,
    /// The mean gaze of the training recordings, always.
    pub mean: T,
    /// Hu et al. 2019, without salient places.
    pub sgaze: T,
    /// Lu et al. 2020, Algorithm 1.
    #[serde(rename = "lu-2020")]
    pub lu_2020: T,
    /// The saturating curve of a preset.
    pub foveal: T,
}

impl<T> ByPredictor<T> {
    /// Names and values, in order.
    #[must_use]
    pub fn each(&self) -> [(&'static str, &T); 5] {
        [
            ("centre", &self.centre),
            ("mean", &self.mean),
            ("sgaze", &self.sgaze),
            ("lu-2020", &self.lu_2020),
            ("foveal", &self.foveal),
        ]
    }

    fn map<U>(self, mut f: impl FnMut(T) -> U) -> ByPredictor<U> {
        ByPredictor {
            centre: f(self.centre),
            mean: f(self.mean),
            sgaze: f(self.sgaze),
            lu_2020: f(self.lu_2020),
            foveal: f(self.foveal),
        }
    }
}

/// Errors over all recordings, and the mean error in degrees of each.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadReport {
    /// Over the rows of all recordings.
    pub pooled: ByPredictor<AngleStatistics>,
    /// Mean error per recording, in the order given.
    pub recordings: Vec<ByPredictor<f64>>,
}

/// Judges all predictors, with one preset and training mean per recording.
///
/// # Panics
/// Unless there are as many fits as recordings.
#[must_use]
pub fn evaluate_head(recordings: &[HeadRecording], fits: &[HeadFit]) -> HeadReport {
    assert_eq!(recordings.len(), fits.len(), "one fit for each recording");
    let mut pooled = ByPredictor::<Vec<f64>>::default();
    let mut means = Vec::new();
    for (recording, fit) in recordings.iter().zip(fits) {
        let errors = errors_deg(recording, fit);
        for (all, (_, new)) in [
            &mut pooled.centre,
            &mut pooled.mean,
            &mut pooled.sgaze,
            &mut pooled.lu_2020,
            &mut pooled.foveal,
        ]
        .into_iter()
        .zip(errors.each())
        {
            all.extend_from_slice(new);
        }
        means.push(errors.map(|errors| mean(&errors)));
    }
    HeadReport {
        pooled: pooled.map(AngleStatistics::of),
        recordings: means,
    }
}

/// For each recording, the fit of all others.
///
/// # Panics
/// Of fewer than two recordings.
#[must_use]
pub fn leave_one_out(recordings: &[HeadRecording]) -> Vec<HeadFit> {
    (0..recordings.len())
        .map(|left_out| {
            let others: Vec<&HeadRecording> = recordings
                .iter()
                .enumerate()
                .filter(|(index, _)| *index != left_out)
                .map(|(_, recording)| recording)
                .collect();
            fit_head(&others)
        })
        .collect()
}

/// The error of each predictor in each row, in degrees.
fn errors_deg(recording: &HeadRecording, fit: &HeadFit) -> ByPredictor<Vec<f64>> {
    let mut sgaze = Sgaze::default();
    let mut errors = ByPredictor::<Vec<f64>>::default();
    for HeadRow { gaze, head } in recording.rows() {
        let error = |predicted: GazeInHead| predicted.angle_to(*gaze).to_degrees();
        errors.centre.push(error(GazeInHead::CENTRE));
        errors.mean.push(error(fit.mean));
        errors.sgaze.push(error(sgaze.predict(head)));
        errors.lu_2020.push(error(predict_lu_2020(head)));
        errors.foveal.push(error(fit.preset.predict(&head.motion)));
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::super::synthetic_viewer::viewer;
    use super::*;
    use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;

    #[test]
    fn viewers_of_the_saturating_law_are_predicted_best_by_it() {
        let law = HeadGazePreset::free_viewing();
        let recordings: Vec<HeadRecording> = (1..4).map(|seed| viewer(&law, 3.0, seed)).collect();
        let report = evaluate_head(&recordings, &leave_one_out(&recordings));
        let mean_deg = report.pooled.map(|statistics| statistics.mean_deg);
        assert!(mean_deg.foveal < 0.92 * mean_deg.sgaze, "{mean_deg:?}");
        assert!(mean_deg.foveal < mean_deg.lu_2020, "{mean_deg:?}");
        assert!(mean_deg.sgaze < mean_deg.centre, "{mean_deg:?}");
        assert!(mean_deg.mean < mean_deg.centre, "{mean_deg:?}");
        for one in &report.recordings {
            assert!(one.foveal < one.sgaze, "{one:?}");
        }
    }

    #[test]
    fn a_recording_left_out_does_not_change_its_own_fit() {
        let law = HeadGazePreset::free_viewing();
        let mut recordings: Vec<HeadRecording> =
            (1..4).map(|seed| viewer(&law, 3.0, seed)).collect();
        let before = leave_one_out(&recordings);
        recordings[1] = viewer(&HeadGazePreset::search(), 3.0, 9);
        let after = leave_one_out(&recordings);
        assert_eq!(before[1], after[1]);
        assert_ne!(before[0], after[0]);
    }

    #[test]
    fn no_predictor_sees_what_comes_later() {
        let whole = viewer(&HeadGazePreset::free_viewing(), 3.0, 5);
        let half = HeadRecording::new(whole.rows()[..1000].to_vec()).unwrap();
        let fit = HeadFit::shipped(HeadGazePreset::free_viewing());
        let [whole, half] = [whole, half].map(|recording| errors_deg(&recording, &fit));
        for ((_, whole), (_, half)) in whole.each().into_iter().zip(half.each()) {
            assert_eq!(whole[..1000], half[..]);
        }
    }
}
