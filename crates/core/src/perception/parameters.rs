//! Which numbers does the model of the eye take, and where do they come from?

use super::measured::acuity::MeasuredAcuity;
use super::measured::sensitivity::MeasuredSensitivity;
use crate::gaze::sample::EyeEvent;
use crate::units::{Cpd, Radians, Seconds};
use serde::{Deserialize, Serialize};

/// Which equations are followed; named in every result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Chen et al. 2022 as printed, with sensitivity inside the Weber ratio (their code; the text
    /// leaves omega without effect) and octave bands (their Eq. 17 has no consistent unit).
    Paper,
    /// Corrected: visible error removed minus lambda times visible change, with sensitivity that
    /// knows eccentricity, luminance and flicker, one polarity of cells and four meridians.
    #[default]
    Default,
}

/// What the eye does while a step is shown, as far as its worth depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EyeState {
    /// Fixating or following: changes are seen, where the gaze is.
    #[default]
    Steady,
    /// Just landed from a saccade: errors are seen where the gaze is, changes hardly.
    Landed,
    /// In a saccade or closed: nothing is seen, and where the gaze will be is open.
    Jumping,
}

/// Every number of the perception model. Names are those that [`Parameters::set`] takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Which equations are followed.
    pub model: Model,
    /// Weight of popping against what is gained: Chen et al. 2022, Eq. 3 (pilot study).
    pub lambda: f64,
    /// That weight from the start of a saccade until `landed_ms` after it; at most 0, because a
    /// change that is made unseen need not be made in sight. `default` model only.
    pub lambda_suppressed: f64,
    /// Seen contrast from which Weber's law holds, in thresholds: Chen et al. 2022, Eq. 2
    /// (1 / masking constant of Mantiuk et al. 2021 is 9.4).
    pub omega: f64,
    /// Importance of every pixel besides acuity, in cycles per degree: Chen et al. 2022, section 4.
    /// `paper` model only.
    pub pedestal: f64,
    /// How long after a saccade changes stay hard to see, in ms: suppression lasts at least 100 ms
    /// (Knoell et al. 2011, Albert et al. 2017). `default` model only.
    pub landed_ms: f64,
    /// After a jump a place lies at any eccentricity up to this, in degrees: half the diagonal of
    /// the field of a headset.
    pub saccade_field_deg: f64,
    /// Luminance of white in cd/m²: a headset (Mantiuk et al. 2021, standard HMD).
    pub peak: f64,
    /// Luminance of black in cd/m²; above 0, so that contrast is finite.
    pub black: f64,
    /// Luminance that the eye is adapted to, in cd/m². `paper`: 100, the published code's;
    /// `default`: 18 % of `peak`, mid-grey.
    pub luminance: f64,
    /// Highest frequency of the display in cycles per degree; 0 for that of the picture's pixels
    /// (Chen et al. 2022, Eq. 14).
    pub display_cpd: f64,
    /// Factor on sensitivity for pictures against laboratory thresholds: Mantiuk et al. 2021, v1.2,
    /// 16.2596 dB. `default` model only.
    pub sensitivity_gain: f64,
    /// Weight of the flicker channel: Mantiuk et al. 2021, v1.2. `default` model only.
    pub flicker_weight: f64,
    /// What this eye resolves, in the place of what the model says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acuity: Option<MeasuredAcuity>,
    /// Its sensitivity to a still pattern and to a change, in the place of what the model says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<MeasuredSensitivity>,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            model: Model::Default,
            lambda: 3.0,
            lambda_suppressed: -3.0,
            omega: 10.0,
            pedestal: 2.0,
            landed_ms: 100.0,
            saccade_field_deg: 40.0,
            peak: 100.0,
            black: 0.1,
            luminance: 18.0,
            display_cpd: 0.0,
            sensitivity_gain: 6.5010,
            flicker_weight: 0.25,
            acuity: None,
            sensitivity: None,
        }
    }
}

/// A parameter that cannot be set to a value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// No parameter is called so.
    #[error("no parameter {name:?}; there are {}", NAMED.map(|named| named.name).join(", "))]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// The value makes no sense for it.
    #[error("{name} is {value}; give {range}")]
    Range {
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What it takes.
        range: String,
    },
}

/// What is known of a parameter that can be set.
#[derive(Clone, Copy, Debug)]
pub struct NamedParameter {
    /// As users write it.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Of its value; nothing for a plain number.
    pub unit: &'static str,
    /// Least and most that it takes.
    pub range: [f64; 2],
}

impl NamedParameter {
    const fn new(
        name: &'static str,
        unit: &'static str,
        range: [f64; 2],
        what: &'static str,
    ) -> Self {
        Self {
            name,
            what,
            unit,
            range,
        }
    }

    fn holds(&self, value: f64) -> bool {
        value >= self.range[0] && value <= self.range[1]
    }
}

const NOT_NEGATIVE: [f64; 2] = [0.0, 1e6];
const POSITIVE: [f64; 2] = [1e-6, 1e6];
const NOT_POSITIVE: [f64; 2] = [-1e6, 0.0];

/// Every parameter that [`Parameters::set`] takes.
pub const NAMED: [NamedParameter; 12] = [
    NamedParameter::new(
        "lambda",
        "",
        NOT_NEGATIVE,
        "weight of popping against what is gained",
    ),
    NamedParameter::new(
        "lambda_suppressed",
        "",
        NOT_POSITIVE,
        "the same in a saccade and until landed_ms after it",
    ),
    NamedParameter::new(
        "omega",
        "thresholds",
        POSITIVE,
        "seen contrast from which Weber's law holds",
    ),
    NamedParameter::new(
        "pedestal",
        "cycles per degree",
        NOT_NEGATIVE,
        "importance of every pixel besides acuity, of the paper's model and of eccentricity",
    ),
    NamedParameter::new(
        "landed_ms",
        "ms",
        NOT_NEGATIVE,
        "how long after a saccade changes stay hard to see",
    ),
    NamedParameter::new(
        "saccade_field_deg",
        "degrees",
        [1.0, 180.0],
        "eccentricity that a place may have after a jump",
    ),
    NamedParameter::new("peak", "cd/m²", POSITIVE, "luminance of white"),
    NamedParameter::new(
        "black",
        "cd/m²",
        POSITIVE,
        "luminance of black, less than peak",
    ),
    NamedParameter::new(
        "luminance",
        "cd/m²",
        POSITIVE,
        "luminance that the eye is adapted to",
    ),
    NamedParameter::new(
        "display_cpd",
        "cycles per degree",
        NOT_NEGATIVE,
        "highest frequency of the display, 0 for that of its pixels",
    ),
    NamedParameter::new(
        "sensitivity_gain",
        "",
        NOT_NEGATIVE,
        "sensitivity to pictures over that in a laboratory",
    ),
    NamedParameter::new(
        "flicker_weight",
        "",
        NOT_NEGATIVE,
        "weight of the flicker channel",
    ),
];

impl Parameters {
    /// The parameters of a model.
    #[must_use]
    pub fn of(model: Model) -> Self {
        let base = Self {
            model,
            ..Self::default()
        };
        match model {
            Model::Default => base,
            Model::Paper => Self {
                luminance: 100.0,
                ..base
            },
        }
    }

    /// Sets a parameter by its name.
    ///
    /// # Errors
    /// When there is no such parameter or the value is out of its range.
    ///
    /// ```
    /// let mut parameters = foveal_core::perception::parameters::Parameters::default();
    /// parameters.set("lambda", 2.5)?;
    /// assert_eq!(parameters.lambda, 2.5);
    /// assert!(parameters.set("lamda", 2.5).is_err());
    /// # Ok::<(), foveal_core::perception::parameters::ParameterError>(())
    /// ```
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), ParameterError> {
        let unknown = || ParameterError::Unknown {
            name: name.to_owned(),
        };
        let named = NAMED.iter().find(|named| named.name == name);
        let named = named.ok_or_else(unknown)?;
        if !named.holds(value) {
            let NamedParameter { name, unit, .. } = *named;
            let [least, most] = named.range;
            return Err(ParameterError::Range {
                name,
                value,
                range: format!("{least} to {most} {unit}").trim_end().to_owned(),
            });
        }
        if let Some(place) = self.place(name) {
            *place = value;
        }
        Ok(())
    }

    /// A parameter by its name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.clone().place(name).copied()
    }

    fn place(&mut self, name: &str) -> Option<&mut f64> {
        Some(match name {
            "lambda" => &mut self.lambda,
            "lambda_suppressed" => &mut self.lambda_suppressed,
            "omega" => &mut self.omega,
            "pedestal" => &mut self.pedestal,
            "landed_ms" => &mut self.landed_ms,
            "saccade_field_deg" => &mut self.saccade_field_deg,
            "peak" => &mut self.peak,
            "black" => &mut self.black,
            "luminance" => &mut self.luminance,
            "display_cpd" => &mut self.display_cpd,
            "sensitivity_gain" => &mut self.sensitivity_gain,
            "flicker_weight" => &mut self.flicker_weight,
            _ => return None,
        })
    }

    /// What an eye that does `event`, and whose last saccade ended `since_saccade` ago, sees of a
    /// step. A lost eye counts as steady: nothing may be risked on a guess.
    #[must_use]
    pub fn eye_state(&self, event: EyeEvent, since_saccade: Option<Seconds>) -> EyeState {
        let window = Seconds(self.landed_ms / 1000.0);
        match event {
            EyeEvent::Saccade | EyeEvent::Blink => EyeState::Jumping,
            _ if since_saccade.is_some_and(|since| since <= window) => EyeState::Landed,
            _ => EyeState::Steady,
        }
    }

    /// Highest frequency that the display shows.
    #[must_use]
    pub fn display_limit(&self) -> Cpd {
        Cpd(if self.display_cpd > 0.0 {
            self.display_cpd
        } else {
            f64::INFINITY
        })
    }

    /// Eccentricities that a place may have after a jump.
    pub(super) fn saccade_field(&self) -> Radians {
        Radians::from_degrees(self.saccade_field_deg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_named_parameter_can_be_set_and_no_other() {
        for named in NAMED {
            let name = named.name;
            let value = if named.holds(7.0) { 7.0 } else { -7.0 };
            let mut parameters = Parameters::default();
            parameters.set(name, value).unwrap();
            assert_eq!(parameters.place(name).copied(), Some(value));
            assert_ne!(parameters, Parameters::default(), "{name}");
            for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert!(parameters.set(name, wrong).is_err(), "{name} {wrong}");
            }
        }
        let error = Parameters::default().set("Lambda", 1.0).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("lambda, lambda_suppressed, omega")
        );
    }

    #[test]
    fn suppressed_lambda_is_never_positive() {
        assert!(Parameters::default().set("lambda_suppressed", 0.1).is_err());
        assert!(Parameters::default().lambda_suppressed <= 0.0);
    }

    #[test]
    fn suppression_outlasts_the_saccade() {
        let parameters = Parameters::default();
        let state = |event, ms: f64| parameters.eye_state(event, Some(Seconds(ms / 1000.0)));
        assert_eq!(state(EyeEvent::Saccade, 0.0), EyeState::Jumping);
        assert_eq!(state(EyeEvent::Fixation, 99.0), EyeState::Landed);
        assert_eq!(state(EyeEvent::Fixation, 101.0), EyeState::Steady);
        assert_eq!(
            parameters.eye_state(EyeEvent::Fixation, None),
            EyeState::Steady
        );
        assert_eq!(parameters.eye_state(EyeEvent::Lost, None), EyeState::Steady);
        assert_eq!(
            parameters.eye_state(EyeEvent::Blink, None),
            EyeState::Jumping
        );
    }
}
