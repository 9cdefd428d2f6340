//! What is a step to a finer level worth to the eye?
//!
//! The one home of the formula: whole pictures ([`super::importance`]), the fast path, and
//! signatures of content that is not at hand all ask here.

use super::eye::Seen;
use super::parameters::{EyeState, Model, Parameters};
use crate::units::{Cpd, Radians};
use serde::{Deserialize, Serialize};

/// Contrast of one octave band before and after a step, at one pixel or averaged over a place. All
/// of them are sizes: 0 or more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BandStep {
    /// Centre of the band at the eye.
    pub cpd: Cpd,
    /// Contrast of what is shown.
    pub contrast_before: f64,
    /// Contrast of what would be shown.
    pub contrast_after: f64,
    /// Contrast of the difference.
    pub difference: f64,
}

/// The value of a step as a sum of what the eye gets: each term times its weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weights {
    /// Of acuity in cycles per degree, for every pixel.
    pub acuity: f64,
    /// Of one, for every pixel.
    pub constant: f64,
    /// Of visible error removed, for every band.
    pub error: f64,
    /// Of popping, for every band.
    pub popping: f64,
    /// Whether a pixel counts by its square degrees (else as one, as printed).
    pub by_area: bool,
}

impl Parameters {
    /// How terms are weighed in a state of the eye.
    ///
    /// `paper`: Chen et al. 2022, Eq. 3. `default`: visible error removed minus lambda times
    /// visible change.
    #[must_use]
    pub fn weights(&self, state: EyeState) -> Weights {
        match (self.model, state) {
            (Model::Paper, EyeState::Jumping) => Weights {
                popping: 1.0,
                ..Weights::default()
            },
            (Model::Paper, _) => Weights {
                acuity: 1.0,
                constant: self.pedestal,
                popping: -self.lambda,
                ..Weights::default()
            },
            (Model::Default, state) => Weights {
                error: 1.0,
                popping: match state {
                    EyeState::Steady => -self.lambda,
                    EyeState::Landed | EyeState::Jumping => -self.lambda_suppressed,
                },
                by_area: true,
                ..Weights::default()
            },
        }
    }
}

/// Popping of one band: the visible change relative to what is seen before it, Weber's ratio with
/// short-term memory. Chen et al. 2022, Eq. 2, with sensitivity inside the ratio.
#[must_use]
pub fn popping(seen: Seen, omega: f64, band: &BandStep) -> f64 {
    let change = seen.transient * band.difference;
    change / (seen.transient * band.contrast_before + omega)
}

/// Visible error that a step removes from one band, in thresholds. What is shown after the step is
/// the truth as far as the step goes, so the errors of single steps add up to that of all.
#[must_use]
pub fn error_removed(seen: Seen, band: &BandStep) -> f64 {
    seen.sustained * band.difference
}

/// What one band adds to the value of a step.
#[must_use]
pub fn band_gain(weights: &Weights, seen: Seen, omega: f64, band: &BandStep) -> f64 {
    weights.error * error_removed(seen, band) + weights.popping * popping(seen, omega, band)
}

/// Value of a step from band contrasts alone, `eccentricity` from the gaze (its spread taken in,
/// see [`super::spread::effective_eccentricity`]), for an eye adapted to `luminance` cd/m².
///
/// Model `default`: per square degree. Model `paper`: per pixel, as printed. A step over several
/// levels is the sum of its single steps. Costs some microseconds per band.
///
/// ```
/// use foveal_core::perception::gain::{BandStep, step_gain};
/// use foveal_core::perception::parameters::{EyeState, Parameters};
/// use foveal_core::units::{Cpd, Radians};
///
/// let detail = BandStep { cpd: Cpd(6.0), contrast_after: 0.2, difference: 0.2,
/// ..BandStep::default() }; let gain = |degrees| {
///     let eccentricity = Radians::from_degrees(degrees);
///     step_gain(&Parameters::default(), &[detail], eccentricity, EyeState::Steady, 18.0)
/// };
/// assert!(gain(1.0) > gain(10.0) && gain(10.0) > gain(40.0));
/// ```
#[must_use]
pub fn step_gain(
    parameters: &Parameters,
    bands: &[BandStep],
    eccentricity: Radians,
    state: EyeState,
    luminance: f64,
) -> f64 {
    let weights = parameters.weights(state);
    let limit = parameters.acuity_model().best_acuity(eccentricity);
    let whole = weights.acuity * limit.0 + weights.constant;
    bands.iter().fold(whole, |sum, band| {
        let seen = match state {
            EyeState::Jumping => parameters.seen_from_anywhere(band.cpd, luminance),
            _ => parameters.seen(band.cpd, eccentricity, limit, luminance),
        };
        sum + band_gain(&weights, seen, parameters.omega, band)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MODELS: [Model; 2] = [Model::Paper, Model::Default];
    const STATES: [EyeState; 3] = [EyeState::Steady, EyeState::Landed, EyeState::Jumping];

    fn band(cpd: f64, before: f64, after: f64) -> BandStep {
        BandStep {
            cpd: Cpd(cpd),
            contrast_before: before,
            contrast_after: after,
            difference: (before - after).abs(),
        }
    }

    fn any_band() -> impl Strategy<Value = BandStep> {
        // Detail that a finer level brings: it holds all that the coarser one holds.
        (1.0..30.0, 0.0..0.5, 0.0..0.5).prop_map(|(cpd, low, more)| band(cpd, low, low + more))
    }

    proptest! {
        #[test]
        fn gain_never_rises_with_eccentricity(
            bands in proptest::collection::vec(any_band(), 1..6),
            near in 0.0..60.0,
            farther in 0.0..30.0,
        ) {
            let gain = |degrees| step_gain(
                &Parameters::default(), &bands, Radians::from_degrees(degrees),
                EyeState::Steady, 20.0);
            let (near, far) = (gain(near), gain(near + farther));
            prop_assert!(far <= near + 1e-9 * near.abs(), "{} {}", near, far);
        }

        #[test]
        fn in_a_saccade_it_does_not_matter_where_the_gaze_is(
            bands in proptest::collection::vec(any_band(), 1..6),
            degrees in 0.0..80.0,
        ) {
            for model in MODELS {
                let parameters = Parameters::of(model);
                let gain = |degrees| step_gain(
                    &parameters, &bands, Radians::from_degrees(degrees), EyeState::Jumping, 20.0);
                prop_assert_eq!(gain(degrees), gain(0.0));
            }
        }

        #[test]
        fn what_already_shows_contrast_masks_the_change(
            cpd in 1.0..16.0, before in 0.0..0.4, more in 0.01..0.4, change in 0.01..0.5,
        ) {
            let seen = Parameters::default().seen(
                Cpd(cpd), Radians(0.0), Cpd(60.0), 20.0);
            let on = |before| popping(seen, 10.0, &band(cpd, before, before + change));
            prop_assert!(on(before + more) < on(before));
        }

        #[test]
        fn a_change_that_is_not_seen_is_worth_more_than_one_that_is(
            bands in proptest::collection::vec(any_band(), 1..6),
            degrees in 0.0..60.0,
        ) {
            let gain = |state| step_gain(
                &Parameters::default(), &bands, Radians::from_degrees(degrees), state, 20.0);
            prop_assert!(gain(EyeState::Landed) >= gain(EyeState::Steady));
        }
    }

    #[test]
    fn a_step_that_changes_nothing_is_worth_nothing_but_acuity() {
        for model in MODELS {
            for state in STATES {
                let parameters = Parameters::of(model);
                let same = [band(1.0, 0.3, 0.3), band(4.0, 0.1, 0.1)];
                let gain = |bands| step_gain(&parameters, bands, Radians(0.1), state, 20.0);
                assert_eq!(gain(&same), gain(&[]));
                assert!(model == Model::Paper || gain(&same) == 0.0);
            }
        }
    }

    #[test]
    fn detail_that_is_missing_is_worth_showing_at_the_fovea() {
        // Below about a third of a cycle per degree a sudden change costs more than it brings.
        for cpd in [0.5, 1.0, 2.0, 4.0, 8.0, 16.0] {
            let gain = |contrast| {
                let bands = [band(cpd, 0.0, contrast)];
                step_gain(
                    &Parameters::default(),
                    &bands,
                    Radians(0.0),
                    EyeState::Steady,
                    20.0,
                )
            };
            assert!(
                gain(0.05) > 0.0 && gain(0.3) > gain(0.05),
                "{cpd}: {} {}",
                gain(0.05),
                gain(0.3)
            );
        }
    }

    #[test]
    fn sensitivity_counts_inside_the_weber_ratio() {
        // Seen contrast 0.2 x 134 becomes 0.5 x 134: (67 - 26.8) / (26.8 + 10).
        let seen = Seen {
            sustained: 134.0,
            transient: 134.0,
        };
        let found = popping(seen, 10.0, &band(4.0, 0.2, 0.5));
        assert!((found - 40.2 / 36.8).abs() < 1e-12, "{found}");
    }
}
