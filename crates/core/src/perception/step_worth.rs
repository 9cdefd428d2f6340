//! What is a step worth whose signature is known, at a place of the view?
//!
//! Signature times sensitivity, for any kind of content: what the step adds in each octave, and how
//! well the eye sees that octave there.

use crate::perception::eye::{Seen, share_of_octave_below};
use crate::perception::gain::{band_gain, error_removed};
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::signature::band_steps;
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::perception::sensitivity_table::SensitivityTable;
use crate::units::{Cpd, Ppd, Radians};
use std::sync::OnceLock;

/// Slope of the chance of seeing a contrast, which is given in thresholds.
const SEEING_EXPONENT: f64 = 3.5;

/// How an eye sees a place of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookedPlace {
    /// From the gaze.
    pub eccentricity: Radians,
    /// By how many octaves eccentricity raises frequency at the cortex.
    pub octaves_raised: f64,
    /// Highest frequency that the eye resolves there.
    pub acuity: Cpd,
    /// Highest frequency that the display shows there.
    pub display: Cpd,
}

impl LookedPlace {
    /// A place at an eccentricity, where the display shows frequencies up to `display`.
    #[must_use]
    pub fn at(parameters: &Parameters, eccentricity: Radians, display: Cpd) -> Self {
        let most = parameters.display_limit();
        Self {
            eccentricity,
            octaves_raised: parameters.octaves_raised(eccentricity),
            acuity: parameters.acuity_model().best_acuity(eccentricity),
            display: if most < display { most } else { display },
        }
    }

    fn limit(&self) -> Cpd {
        if self.acuity < self.display {
            self.acuity
        } else {
            self.display
        }
    }
}

/// How what is finer than the pixels of a display is drawn on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawnFiner {
    /// Not at all: a filter takes it out.
    Filtered,
    /// As noise: each pixel shows what lies in its middle, and detail is seen as the finest that
    /// the display shows.
    Sampled,
}

/// Values steps by their signatures.
#[derive(Clone, Debug)]
pub struct StepWorth {
    parameters: Parameters,
    drawn: DrawnFiner,
    /// What a steady or landed eye sees, and what a jumping one does; made when first asked for.
    seen: [OnceLock<SensitivityTable>; 2],
}

impl StepWorth {
    /// The worth of steps to an eye with these parameters.
    #[must_use]
    pub fn new(parameters: &Parameters) -> Self {
        Self {
            parameters: parameters.clone(),
            drawn: DrawnFiner::Filtered,
            seen: Default::default(),
        }
    }

    /// The same for content that is drawn so.
    #[must_use]
    pub fn of_what_is_drawn(parameters: &Parameters, drawn: DrawnFiner) -> Self {
        Self {
            drawn,
            ..Self::new(parameters)
        }
    }

    /// What a step is worth that is seen at `place` with `ppd` of the signature's pixels a degree:
    /// for each of what [`Self::extent`] counts. Takes about a tenth of a microsecond.
    #[must_use]
    pub fn gain(
        &self,
        signature: &Signature,
        ppd: Ppd,
        place: &LookedPlace,
        state: EyeState,
    ) -> f64 {
        let weights = self.parameters.weights(state);
        let mut gain = weights.acuity * place.acuity.0 + weights.constant;
        for band in band_steps(signature, ppd) {
            if band.difference > 0.0 {
                let seen = self.seen(self.shown(band.cpd, place), place, state);
                gain += band_gain(&weights, seen, self.parameters.omega, &band);
            }
        }
        gain
    }

    /// How many of the samples that an eye takes in a square degree at `place` see what a step
    /// changes there: samples at twice the highest frequency that it resolves, times the chance of
    /// seeing a difference (Quick 1974, with Weibull's exponent of Robson and Graham 1981, over the
    /// bands). Under the published model [`Self::gain`], as printed.
    ///
    /// So a difference that is clearly seen counts no more than one that is just seen, and one that
    /// is below the threshold next to nothing.
    #[must_use]
    pub fn seen_samples(
        &self,
        signature: &Signature,
        ppd: Ppd,
        place: &LookedPlace,
        state: EyeState,
    ) -> f64 {
        if self.parameters.model == Model::Paper {
            return self.gain(signature, ppd, place, state) * self.extent(ppd, 1.0, place);
        }
        let evidence = band_steps(signature, ppd).into_iter().map(|band| {
            let seen = self.seen(self.shown(band.cpd, place), place, state);
            libm::pow(error_removed(seen, &band), SEEING_EXPONENT)
        });
        let samples = 4.0 * place.acuity.0 * place.acuity.0;
        samples * -libm::expm1(-evidence.sum::<f64>())
    }

    /// What a place counts that fills so many square degrees with content of `ppd`: these, or, as
    /// Chen et al. 2022 printed it, pixels of the display; without a display, of the content.
    #[must_use]
    pub fn extent(&self, ppd: Ppd, area_deg2: f64, place: &LookedPlace) -> f64 {
        if self.parameters.weights(EyeState::Steady).by_area {
            return area_deg2;
        }
        let ppd = ppd.0.min(2.0 * place.display.0);
        area_deg2 * ppd * ppd
    }

    /// The frequency at which a band is seen.
    fn shown(&self, band: Cpd, place: &LookedPlace) -> Cpd {
        match self.drawn {
            DrawnFiner::Filtered => band,
            // The octave that ends at the display's limit.
            DrawnFiner::Sampled => Cpd(band.0.min(place.display.0 / core::f64::consts::SQRT_2)),
        }
    }

    fn seen(&self, frequency: Cpd, place: &LookedPlace, state: EyeState) -> Seen {
        let octave = libm::log2(frequency.0);
        let table = |k: usize, state| {
            self.seen[k].get_or_init(|| SensitivityTable::new(&self.parameters, state))
        };
        let (table, octave, limit) = if state == EyeState::Jumping {
            (table(1, EyeState::Jumping), octave, place.display)
        } else {
            let octave = octave + place.octaves_raised;
            (table(0, EyeState::Steady), octave, place.limit())
        };
        let share = share_of_octave_below(frequency, limit);
        let [sustained, transient] = table
            .at(octave as f32, place.eccentricity.0 as f32)
            .map(|s| f64::from(s) * share);
        Seen {
            sustained,
            transient,
        }
    }
}
