//! What is a step worth whose signature is known, at a place of the view?
//!
//! Signature times sensitivity, for any kind of content: what the step adds in each octave, and how
//! well the eye sees that octave there.

use crate::perception::eye::{Seen, share_of_octave_below};
use crate::perception::gain::band_gain;
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::signature::band_steps;
use crate::perception::parameters::{EyeState, Model, Parameters};
use crate::perception::sensitivity_table::SensitivityTable;
use crate::perception::visible_loss::DIFFERENCE_EXPONENT;
use crate::units::{Cpd, Ppd, Radians};
use std::sync::OnceLock;

/// How an eye sees a place of the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPlace {
    /// By how many octaves eccentricity raises frequency at the cortex.
    pub octaves_raised: f64,
    /// Highest frequency that the eye resolves there.
    pub acuity: Cpd,
    /// Highest frequency that the display shows there.
    pub display: Cpd,
}

impl SeenPlace {
    /// A place at an eccentricity, where the display shows frequencies up to `display`.
    #[must_use]
    pub fn at(parameters: &Parameters, eccentricity: Radians, display: Cpd) -> Self {
        let most = parameters.display_limit();
        Self {
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
    /// As noise: each pixel shows what lies in its middle, and detail is seen as the finest that the
    /// display shows.
    Sampled,
}

/// Values steps by their signatures.
#[derive(Clone, Debug)]
pub struct StepWorth {
    parameters: Parameters,
    drawn: DrawnFiner,
    /// Power of the seen difference that counts, in thresholds.
    exponent: f64,
    /// What a steady or landed eye sees, and what a jumping one does; made when first asked for.
    seen: [OnceLock<SensitivityTable>; 2],
}

impl StepWorth {
    /// The worth of steps to an eye with these parameters.
    #[must_use]
    pub fn new(parameters: &Parameters) -> Self {
        Self {
            parameters: *parameters,
            drawn: DrawnFiner::Filtered,
            exponent: 1.0,
            seen: Default::default(),
        }
    }

    /// The same, where differences count as the judge of pictures counts them, by
    /// [`DIFFERENCE_EXPONENT`]: what is below the threshold hardly counts, and what is clearly seen
    /// comes first.
    #[must_use]
    pub fn of_seen_differences(parameters: &Parameters, drawn: DrawnFiner) -> Self {
        let exponent = match parameters.model {
            Model::Default => DIFFERENCE_EXPONENT,
            Model::Paper => 1.0,
        };
        Self {
            drawn,
            exponent,
            ..Self::new(parameters)
        }
    }

    /// What a step is worth that is seen at `place` with `ppd` of the signature's pixels a degree:
    /// for each of what [`Self::extent`] counts. Takes about a tenth of a microsecond.
    #[must_use]
    pub fn gain(&self, signature: &Signature, ppd: Ppd, place: &SeenPlace, state: EyeState) -> f64 {
        let weights = self.parameters.weights(state);
        let mut gain = weights.acuity * place.acuity.0 + weights.constant;
        for band in band_steps(signature, ppd) {
            if band.difference > 0.0 {
                let seen = self.seen(self.shown(band.cpd, place), place, state);
                let of_band = band_gain(&weights, seen, self.parameters.omega, &band);
                gain += match self.exponent {
                    1.0 => of_band,
                    exponent => libm::pow(of_band.max(0.0), exponent),
                };
            }
        }
        gain
    }

    /// What a place counts that fills so many square degrees with content of `ppd`: these, or, as
    /// Chen et al. 2022 printed it, pixels of the display; without a display, of the content.
    #[must_use]
    pub fn extent(&self, ppd: Ppd, area_deg2: f64, place: &SeenPlace) -> f64 {
        if self.parameters.weights(EyeState::Steady).by_area {
            return area_deg2;
        }
        let ppd = ppd.0.min(2.0 * place.display.0);
        area_deg2 * ppd * ppd
    }

    /// The frequency at which a band is seen.
    fn shown(&self, band: Cpd, place: &SeenPlace) -> Cpd {
        match self.drawn {
            DrawnFiner::Filtered => band,
            // The octave that ends at the display's limit.
            DrawnFiner::Sampled => Cpd(band.0.min(place.display.0 / core::f64::consts::SQRT_2)),
        }
    }

    fn seen(&self, frequency: Cpd, place: &SeenPlace, state: EyeState) -> Seen {
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
        let [sustained, transient] = table.at(octave as f32).map(|s| f64::from(s) * share);
        Seen {
            sustained,
            transient,
        }
    }
}
