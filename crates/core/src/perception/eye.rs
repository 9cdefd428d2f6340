//! How strongly does the eye see contrast in one band, at one place?

use super::acuity::AcuityModel;
use super::csf::{SizeTerm, barten};
use super::parameters::{Model, Parameters};
use super::sensitivity::sensitivity;
use super::spread::effective_eccentricity;
use crate::units::{Cpd, Radians};
use crate::view::axes::{Axes, angle_between, yaw_pitch_from_direction};
use glam::DVec3;

/// Flicker rate that stands for a sudden change, in hertz: Mantiuk et al. 2021.
const FLICKER_HERTZ: f64 = 5.0;
/// Eccentricities that the mean over all gaze points is taken over.
const ANYWHERE_STEPS: u32 = 24;

/// Sensitivity (1 / threshold contrast) to the contrast of one band at one place; 0 where the
/// display or the eye resolves none of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// To what stays.
    pub sustained: f64,
    /// To what changes.
    pub transient: f64,
}

impl Seen {
    fn scaled(self, share: f64) -> Self {
        Self {
            sustained: self.sustained * share,
            transient: self.transient * share,
        }
    }
}

impl Parameters {
    /// Which density of cells limits what is resolved.
    #[must_use]
    pub fn acuity_model(&self) -> AcuityModel {
        match (&self.acuity, self.model) {
            (Some(measured), _) => AcuityModel::Table(measured.clone()),
            (None, Model::Paper) => AcuityModel::WatsonPaper,
            (None, Model::Default) => AcuityModel::Watson,
        }
    }

    /// Sensitivity to an octave band round `frequency` at `eccentricity` from the gaze, where the
    /// eye resolves `limit`, on a background of `luminance` cd/m².
    #[must_use]
    pub fn seen(&self, frequency: Cpd, eccentricity: Radians, limit: Cpd, luminance: f64) -> Seen {
        let display = self.display_limit();
        let limit = if display < limit { display } else { limit };
        let share = share_of_octave_below(frequency, limit);
        if share == 0.0 {
            return Seen::default();
        }
        self.sensitivity(frequency, eccentricity, luminance)
            .scaled(share)
    }

    /// Sensitivity to an octave band round `frequency`, averaged over all the places where the gaze
    /// may be after a jump: over the disc of `saccade_field_deg` on the sphere. The same wherever
    /// the gaze is now. Chen et al. 2022, Eq. 3, second case.
    #[must_use]
    pub fn seen_from_anywhere(&self, frequency: Cpd, luminance: f64) -> Seen {
        let (mut sum, mut area) = (Seen::default(), 0.0);
        for step in 0..ANYWHERE_STEPS {
            let share = (f64::from(step) + 0.5) / f64::from(ANYWHERE_STEPS);
            let eccentricity = Radians(self.saccade_field().0 * share);
            let limit = self.acuity_model().best_acuity(eccentricity);
            let ring = libm::sin(eccentricity.0);
            let seen = self.seen(frequency, eccentricity, limit, luminance);
            sum.sustained += ring * seen.sustained;
            sum.transient += ring * seen.transient;
            area += ring;
        }
        sum.scaled(1.0 / area)
    }

    /// Sensitivity without a limit of acuity.
    pub(super) fn sensitivity(
        &self,
        frequency: Cpd,
        eccentricity: Radians,
        luminance: f64,
    ) -> Seen {
        let measured = self.sensitivity.as_ref();
        let measured = measured.map(|measured| measured.at(frequency, eccentricity));
        match self.model {
            Model::Paper => {
                let printed = || barten(frequency, luminance, SizeTerm::Printed);
                let seen = measured.unwrap_or_else(printed);
                Seen {
                    sustained: seen,
                    transient: seen,
                }
            }
            Model::Default => {
                let at = |hertz| {
                    let ours = || sensitivity(frequency, hertz, luminance, eccentricity);
                    self.sensitivity_gain * measured.unwrap_or_else(ours)
                };
                Seen {
                    sustained: at(0.0),
                    transient: self.flicker_weight * at(FLICKER_HERTZ),
                }
            }
        }
    }
}

/// How much of the octave round `frequency` lies below `limit`, 0 to 1. Bands above the limit are
/// dropped (Chen et al. 2022, Eqs. 14, 15), and the one that it runs through in part, so that what
/// is seen is continuous in the gaze.
#[must_use]
pub fn share_of_octave_below(Cpd(frequency): Cpd, Cpd(limit): Cpd) -> f64 {
    if limit >= frequency * 2.0 {
        return 1.0;
    }
    share_of_octave(libm::log2(limit / frequency))
}

/// [`share_of_octave_below`] of an octave whose middle lies so many octaves below the limit.
#[must_use]
pub fn share_of_octave(octaves_below: f64) -> f64 {
    (octaves_below + 0.5).clamp(0.0, 1.0)
}

/// An eye that looks somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    /// Unit direction in the space of the view.
    pub direction: DVec3,
    /// One standard deviation of that direction.
    pub spread: Radians,
}

/// What the eye can resolve at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolvedPlace {
    /// From the gaze, its spread taken in.
    pub eccentricity: Radians,
    /// Highest frequency that the eye resolves there.
    pub acuity: Cpd,
}

impl Gaze {
    /// What this eye resolves in a unit `direction`, under a model.
    #[must_use]
    pub fn place(&self, direction: DVec3, model: &AcuityModel) -> ResolvedPlace {
        let apart = angle_between(self.direction, direction);
        let eccentricity = effective_eccentricity(apart, self.spread);
        // As far out as the spread makes it, in the same direction from the gaze.
        let off = direction - self.direction * direction.dot(self.direction);
        let across = if off.length() > 1e-9 {
            off.normalize()
        } else {
            let (yaw, pitch) = yaw_pitch_from_direction(self.direction);
            Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0)).right
        };
        let along = self.direction * libm::cos(eccentricity.0);
        let there = along + across * libm::sin(eccentricity.0);
        ResolvedPlace {
            eccentricity,
            acuity: model.acuity(self.direction, there),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_fades_out_over_the_octave_that_the_limit_runs_through() {
        let share = |limit| share_of_octave_below(Cpd(4.0), Cpd(limit));
        assert_eq!(share(2.0), 0.0);
        assert!((share(4.0) - 0.5).abs() < 1e-12);
        assert_eq!(share(8.0), 1.0);
        assert_eq!(share(0.0), 0.0);
        assert_eq!(share(f64::INFINITY), 1.0);
    }

    #[test]
    fn acuity_is_continuous_at_the_gaze() {
        let gaze = Gaze {
            direction: DVec3::NEG_Z,
            spread: Radians(0.0),
        };
        for model in [AcuityModel::Watson, AcuityModel::WatsonPaper] {
            let at = |x: f64, y: f64| {
                let direction = DVec3::new(x, y, -1.0).normalize();
                gaze.place(direction, &model).acuity.0
            };
            let centre = at(0.0, 0.0);
            for tiny in [1e-4, 1e-6, 1e-8, 1e-10] {
                for (x, y) in [(tiny, 0.0), (-tiny, 0.0), (0.0, tiny), (tiny, -tiny)] {
                    let beside = at(x, y);
                    assert!(beside <= centre * (1.0 + 1e-9));
                    assert!(centre - beside < 2.0 * centre * Radians(tiny).to_degrees() + 1e-9);
                }
            }
        }
    }

    #[test]
    fn spread_only_lowers_what_the_gaze_resolves_at_its_own_place() {
        let model = AcuityModel::Watson;
        let at = |spread| {
            let gaze = Gaze {
                direction: DVec3::NEG_Z,
                spread: Radians::from_degrees(spread),
            };
            gaze.place(DVec3::NEG_Z, &model).acuity.0
        };
        assert!(at(0.0) > at(1.0) && at(1.0) > at(2.0) && at(2.0) > at(7.0));
    }

    #[test]
    fn no_gaze_is_better_than_all_gazes_are_on_average() {
        for model in [Model::Paper, Model::Default] {
            let parameters = Parameters::of(model);
            for frequency in [1.0, 4.0, 16.0] {
                let limit = parameters.acuity_model().best_acuity(Radians(0.0));
                let foveal = parameters.seen(Cpd(frequency), Radians(0.0), limit, 100.0);
                let mean = parameters.seen_from_anywhere(Cpd(frequency), 100.0);
                assert!(mean.sustained <= foveal.sustained + 1e-9);
                assert!(mean.sustained > 0.0);
            }
        }
    }
}
