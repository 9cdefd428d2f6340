//! How fine a detail can the eye resolve at a given eccentricity?
//!
//! Two models. The linear one, 1/60° + 0.022 x eccentricity, chooses levels of video; Watson's
//! (2014) follows the density of midget ganglion cells and asks for 2.5–4.6 times more pixels.
//! Sources and tests: docs/papers.md, rows "acuity".

use super::measured::acuity::MeasuredAcuity;
use crate::units::{Cpd, Radians};
use crate::view::axes::{Axes, angle_between, yaw_pitch_from_direction};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Which eye model says what can be resolved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AcuityModel {
    /// Minimum angle of resolution that grows linearly with eccentricity: `mar_deg + slope x e`.
    Linear {
        /// Degrees of the smallest pixel that can be resolved at the fovea.
        mar_deg: f64,
        /// By how many degrees that pixel grows with each degree of eccentricity. Two pixels are a
        /// cycle: who reads the measurements as degrees of a cycle takes half their slope here.
        slope: f64,
    },
    /// Watson 2014 with one polarity of cells (half the density), each meridian its own, the angle
    /// on the sphere, the better of both eyes: the corrected model.
    Watson,
    /// Watson 2014 as Chen et al. 2022 print it (Eqs. 9–11): both polarities, the temporal and
    /// superior meridians mirrored to both sides, two plane angles.
    WatsonPaper,
    /// Measured smallest angles, the same along all meridians.
    Table(MeasuredAcuity),
}

impl AcuityModel {
    /// The default of video: a pixel of 1/60° + 0.022 x eccentricity.
    pub const LINEAR: Self = Self::linear(0.022);

    /// A pixel of 1/60° at the fovea that grows by `slope` degrees with each degree of
    /// eccentricity; no less than 0.
    #[must_use]
    pub const fn linear(slope: f64) -> Self {
        Self::Linear {
            mar_deg: 1.0 / 60.0,
            slope,
        }
    }

    /// Highest spatial frequency that is resolved in `direction` by an eye that looks along
    /// `gaze` (unit vectors of one space).
    #[must_use]
    pub fn acuity(&self, gaze: DVec3, direction: DVec3) -> Cpd {
        let eccentricity = angle_between(gaze, direction);
        match self {
            Self::Linear { .. } | Self::Table(_) => self.best_acuity(eccentricity),
            Self::Watson => {
                let [x, y] = visual_field_offset(gaze, direction);
                let length = (x * x + y * y).sqrt().max(1e-12);
                let on_sphere = eccentricity.to_degrees() / length;
                binocular_acuity([x * on_sphere, y * on_sphere])
            }
            Self::WatsonPaper => {
                let (yaw, pitch) = plane_angles(gaze, direction);
                watson_acuity_paper([yaw.to_degrees(), pitch.to_degrees()])
            }
        }
    }

    /// Whether all directions at an eccentricity have the same acuity.
    #[must_use]
    pub fn is_round(&self) -> bool {
        matches!(self, Self::Linear { .. } | Self::Table(_))
    }

    /// The highest acuity that any direction at this eccentricity has: a bound for skipping.
    #[must_use]
    pub fn best_acuity(&self, eccentricity: Radians) -> Cpd {
        let degrees = eccentricity.to_degrees();
        match self {
            // Two pixels a cycle, one pixel a minimum angle of resolution.
            Self::Linear { mar_deg, slope } => Cpd(0.5 / (mar_deg + slope * degrees)),
            Self::Table(measured) => measured.acuity(eccentricity),
            Self::Watson => {
                let along = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
                best(along.map(|[x, y]| binocular_acuity([x * degrees, y * degrees])))
            }
            Self::WatsonPaper => {
                // Two plane angles are never longer than the angle on the sphere by more than
                // their own sum suggests; the bound takes the foveal side of both meridians.
                let inner = degrees / core::f64::consts::SQRT_2;
                let along = [[inner, 0.0], [0.0, inner]];
                best(along.map(watson_acuity_paper))
            }
        }
    }
}

fn best<const N: usize>(acuities: [Cpd; N]) -> Cpd {
    acuities
        .into_iter()
        .fold(Cpd(0.0), |a, b| if b > a { b } else { a })
}

/// Right and up components of `direction` in the visual field of an upright eye along `gaze`.
fn visual_field_offset(gaze: DVec3, direction: DVec3) -> [f64; 2] {
    let (yaw, pitch) = yaw_pitch_from_direction(gaze);
    let eye = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
    [direction.dot(eye.right), -direction.dot(eye.down)]
}

fn plane_angles(gaze: DVec3, direction: DVec3) -> (Radians, Radians) {
    let (yaw, pitch) = yaw_pitch_from_direction(gaze);
    let eye = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
    let depth = direction.dot(eye.forward);
    (
        Radians(libm::atan2(direction.dot(eye.right), depth)),
        Radians(libm::atan2(-direction.dot(eye.down), depth)),
    )
}

/// A half meridian of the retina, by Watson's names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meridian {
    /// Temporal side of the visual field.
    Temporal,
    /// Watson's "superior": the lower visual field.
    Superior,
    /// Nasal side of the visual field.
    Nasal,
    /// Watson's "inferior": the upper visual field.
    Inferior,
}

/// Density of midget ganglion cells at the fovea's centre, one polarity, per square degree.
const FOVEAL_DENSITY: f64 = 14_804.6;
/// Eccentricity at which midget cells are half of their foveal share, in degrees.
const MIDGET_SCALE_DEG: f64 = 41.03;
/// Hexagonal lattice: spacing² x density.
const HEXAGONAL: f64 = 1.154_700_538_379_251_5;
/// Acuity with one polarity of cells and the hexagonal Nyquist limit, relative to the printed
/// formula: sqrt(2/3).
const SINGLE_POLARITY: f64 = 0.816_496_580_927_726;

impl Meridian {
    /// Watson's a, r2 (degrees) and re (degrees).
    fn parameters(self) -> [f64; 3] {
        match self {
            Self::Temporal => [0.9851, 1.058, 22.14],
            Self::Superior => [0.9935, 1.035, 16.35],
            Self::Nasal => [0.9729, 1.084, 7.633],
            Self::Inferior => [0.9960, 0.9932, 12.13],
        }
    }

    /// Receptive fields of midget ganglion cells per square degree of visual field, both
    /// polarities. Watson 2014, Eq. 8 (Chen et al. 2022, Eq. 9).
    #[must_use]
    pub fn density(self, eccentricity_deg: f64) -> f64 {
        let [a, r2, re] = self.parameters();
        let near = 1.0 + eccentricity_deg / r2;
        let falloff = a / (near * near) + (1.0 - a) * libm::exp(-eccentricity_deg / re);
        2.0 * FOVEAL_DENSITY / (1.0 + eccentricity_deg / MIDGET_SCALE_DEG) * falloff
    }
}

/// Spacing of cells in degrees at (`x`, `y`) degrees from the gaze, between a horizontal and a
/// vertical meridian. Chen et al. 2022, Eq. 10; its limit at the gaze itself.
#[must_use]
pub fn watson_spacing([x, y]: [f64; 2], horizontal: Meridian, vertical: Meridian) -> f64 {
    let r2 = x * x + y * y;
    if r2 < 1e-18 {
        return (HEXAGONAL / horizontal.density(0.0)).sqrt();
    }
    let r = r2.sqrt();
    (HEXAGONAL / r2 * (x * x / horizontal.density(r) + y * y / vertical.density(r))).sqrt()
}

/// Acuity at (`x`, `y`) degrees from the gaze as printed: Chen et al. 2022, Eq. 11, temporal and
/// superior meridians on both sides.
#[must_use]
pub fn watson_acuity_paper(offset_deg: [f64; 2]) -> Cpd {
    Cpd(0.5 / watson_spacing(offset_deg, Meridian::Temporal, Meridian::Superior))
}

/// Acuity of one eye along a half meridian, under a model.
#[must_use]
pub fn acuity_along(model: &AcuityModel, meridian: Meridian, eccentricity_deg: f64) -> Cpd {
    let both = 0.5 / watson_spacing([eccentricity_deg, 0.0], meridian, meridian);
    match model {
        AcuityModel::Linear { .. } | AcuityModel::Table(_) => {
            model.best_acuity(Radians::from_degrees(eccentricity_deg))
        }
        AcuityModel::Watson => Cpd(SINGLE_POLARITY * both),
        AcuityModel::WatsonPaper => Cpd(both),
    }
}

/// Acuity of the better eye at (`x` right, `y` up) degrees from the gaze: one polarity, each
/// meridian its own; what is temporal to one eye is nasal to the other.
#[must_use]
pub fn binocular_acuity([x, y]: [f64; 2]) -> Cpd {
    let vertical = if y > 0.0 {
        Meridian::Inferior
    } else {
        Meridian::Superior
    };
    best([Meridian::Temporal, Meridian::Nasal].map(|horizontal| {
        Cpd(SINGLE_POLARITY * 0.5 / watson_spacing([x, y], horizontal, vertical))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::direction_from_yaw_pitch;
    use Meridian::{Inferior, Nasal, Superior, Temporal};

    fn on_axis(meridian: Meridian, degrees: f64) -> f64 {
        acuity_along(&AcuityModel::WatsonPaper, meridian, degrees).0
    }

    #[test]
    fn acuity_has_the_golden_values_of_every_meridian() {
        let golden = [
            (0.0, [80.066097, 80.066097, 80.066097, 80.066097]),
            (0.1, [73.167689, 72.969261, 73.390454, 72.682884]),
            (0.5, [54.491758, 53.857251, 55.194807, 53.057917]),
            (1.0, [41.453884, 40.577516, 42.379966, 39.631971]),
            (2.0, [28.354782, 27.228802, 29.363152, 26.288097]),
            (5.0, [15.479757, 13.940287, 16.028688, 13.093538]),
            (10.0, [9.765679, 7.951270, 9.254645, 7.137568]),
            (20.0, [6.061193, 4.313917, 4.425470, 3.594814]),
            (30.0, [4.297117, 2.816746, 2.520329, 2.244194]),
            (40.0, [3.172515, 1.969452, 1.632361, 1.542042]),
            (50.0, [2.392102, 1.436298, 1.173774, 1.130983]),
            (60.0, [1.830580, 1.083980, 0.908225, 0.872698]),
        ];
        for (degrees, row) in golden {
            for (meridian, expected) in [Temporal, Superior, Nasal, Inferior].into_iter().zip(row) {
                let found = on_axis(meridian, degrees);
                assert!(
                    (found - expected).abs() < 1e-6,
                    "{meridian:?} {degrees}: {found}"
                );
            }
        }
    }

    #[test]
    fn acuity_has_the_golden_values_off_axis() {
        for (offset, expected) in [
            ([3.0, 4.0], 14.440225),
            ([10.0, 5.0], 8.599525),
            ([20.0, 20.0], 3.549574),
            ([0.5, -1.0], 38.526663),
        ] {
            let Cpd(found) = watson_acuity_paper(offset);
            assert!((found - expected).abs() < 1e-6, "{offset:?}: {found}");
        }
        assert!((binocular_acuity([0.0, 0.0]).0 - 65.373694).abs() < 1e-6);
    }

    #[test]
    fn density_has_the_golden_values_of_every_meridian() {
        let golden = [
            (0.0, [29609.2, 29609.2, 29609.2, 29609.2]),
            (1.0, [7937.0627, 7605.0186, 8295.6527, 7254.7207]),
            (2.0, [3713.4877, 3424.4154, 3982.3066, 3191.8882]),
            (5.0, [1106.7707, 897.5792, 1186.6574, 791.8508]),
            (10.0, [440.4882, 292.0131, 395.5933, 235.3043]),
            (20.0, [169.6858, 85.9553, 90.4583, 59.6873]),
            (30.0, [85.2872, 36.6458, 29.3389, 23.2622]),
            (40.0, [46.4876, 17.9151, 12.3073, 10.9830]),
        ];
        for (degrees, row) in golden {
            for (meridian, expected) in [Temporal, Superior, Nasal, Inferior].into_iter().zip(row) {
                let found = meridian.density(degrees);
                assert!(
                    (found - expected).abs() < 1e-4,
                    "{meridian:?} {degrees}: {found}"
                );
            }
        }
    }

    #[test]
    fn acuity_falls_to_given_frequencies_at_the_golden_eccentricities() {
        for (cpd, temporal, superior) in [
            (30.0, 1.8224, 1.7180),
            (20.0, 3.4260, 3.1161),
            (16.0, 4.7621, 4.1901),
            (7.0, 16.4248, 11.6414),
            (256.0 / 110.0, 51.0041, 35.1624),
            (128.0 / 110.0, 78.1142, 57.3695),
        ] {
            for (meridian, expected) in [(Temporal, temporal), (Superior, superior)] {
                let (mut near, mut far) = (0.0, 120.0);
                for _ in 0..60 {
                    let middle = (near + far) / 2.0;
                    if on_axis(meridian, middle) > cpd {
                        near = middle;
                    } else {
                        far = middle;
                    }
                }
                assert!((near - expected).abs() < 1e-4, "{meridian:?} {cpd}: {near}");
            }
        }
    }

    #[test]
    fn acuity_never_rises_with_eccentricity_and_never_beats_its_bound() {
        let gaze = direction_from_yaw_pitch(Radians(0.3), Radians(0.2));
        let (yaw, pitch) = yaw_pitch_from_direction(gaze);
        let eye = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
        for model in [
            AcuityModel::LINEAR,
            AcuityModel::Watson,
            AcuityModel::WatsonPaper,
        ] {
            for bearing in 0..16 {
                let (sin, cos) = (libm::sin(f64::from(bearing)), libm::cos(f64::from(bearing)));
                let across = eye.right * sin + eye.down * cos;
                let mut before = f64::MAX;
                for step in 0..80 {
                    let angle = Radians::from_degrees(f64::from(step));
                    let direction = gaze * libm::cos(angle.0) + across * libm::sin(angle.0);
                    let Cpd(acuity) = model.acuity(gaze, direction);
                    let Cpd(bound) = model.best_acuity(angle);
                    assert!(
                        acuity <= before + 1e-9,
                        "{model:?} {step}° {acuity} {before}"
                    );
                    assert!(
                        acuity <= bound * (1.0 + 1e-9),
                        "{model:?} {step}° {acuity} {bound}"
                    );
                    before = acuity;
                }
            }
        }
    }

    #[test]
    fn the_linear_fovea_resolves_60_pixels_a_degree() {
        let gaze = DVec3::NEG_Z;
        assert!((AcuityModel::LINEAR.acuity(gaze, gaze).0 - 30.0).abs() < 1e-12);
    }
}
