//! How little contrast does the eye need away from its fovea, in dim or bright surroundings?
//!
//! The spatio-chromatic sensitivity of Mantiuk et al. 2020 for grey patterns, seen through the
//! cortical magnification of Dougherty et al. 2003 and weighed for flicker by Laird et al. 2006, as
//! Mantiuk et al. 2021 (FovVideoVDP) combine them. Sources: docs/papers.md, rows "sensitivity".

use crate::units::{Cpd, Radians};
use core::f64::consts::PI;

/// Eccentricity in degrees at which the cortex gives half of what it gives the fovea.
pub(super) const MAGNIFICATION_DEG: f64 = 3.67;
/// How far sensitivity follows cortical magnification (exponent).
const MAGNIFICATION_EXPONENT: f64 = 0.604_562;
/// Radius of the pattern in cycles.
const RADIUS_CYCLES: f64 = 1.5;

/// Contrast sensitivity (1 / threshold contrast) for a grey pattern of spatial frequency
/// `frequency` (above 0) that flickers at `hertz`, `eccentricity` from the gaze, on a background of
/// `luminance` cd/m² (above 0). Costs about a microsecond.
#[must_use]
pub fn sensitivity(Cpd(frequency): Cpd, hertz: f64, luminance: f64, eccentricity: Radians) -> f64 {
    let magnification = cortical_magnification(eccentricity);
    let at_cortex = frequency / magnification;
    let radius = RADIUS_CYCLES / frequency * magnification;
    let pattern = Pattern {
        frequency: at_cortex,
        area: PI * radius * radius,
        luminance,
    };
    flicker_factor(at_cortex, hertz) * pattern.grey_sensitivity()
}

/// Cortical magnification relative to the fovea, as far as sensitivity follows it: Dougherty et al.
/// 2003, 29.2 / (e + 3.67) mm per degree, to the power that Mantiuk et al. 2021 fitted.
#[must_use]
pub fn cortical_magnification(eccentricity: Radians) -> f64 {
    let share = MAGNIFICATION_DEG / (eccentricity.to_degrees() + MAGNIFICATION_DEG);
    libm::pow(share, MAGNIFICATION_EXPONENT)
}

/// Sensitivity to flicker at `hertz` relative to none: Laird et al. 2006, the spatio-velocity
/// model.
fn flicker_factor(frequency: f64, hertz: f64) -> f64 {
    // Keeps the quotient finite where the model has no sensitivity at all.
    const TINY: f64 = 1e-5;
    let moving = velocity_sensitivity(frequency, hertz / frequency);
    moving / (velocity_sensitivity(frequency, 0.0) + TINY)
}

fn velocity_sensitivity(frequency: f64, velocity: f64) -> f64 {
    const C0: f64 = 0.6329;
    const C1: f64 = 0.8404;
    const C2: f64 = 0.7986;
    // Drift of an eye at rest, in degrees per second.
    let velocity = velocity.max(0.1);
    let scaled = C2 * velocity;
    let decades = libm::log10(scaled / 3.0).abs();
    let k = 6.1 + 7.3 * decades * decades * decades;
    let best = 45.9 / (scaled + 2.0);
    let angular = C1 * 2.0 * PI * frequency;
    k * (C0 * C1 * C2) * velocity * angular * angular * libm::exp(-2.0 * angular / best)
}

/// A pattern as the cortex sees it.
struct Pattern {
    /// Cycles per degree after magnification.
    frequency: f64,
    /// Square degrees after magnification.
    area: f64,
    /// Background in cd/m².
    luminance: f64,
}

/// One of the three colour mechanisms of Mantiuk et al. 2020.
struct Mechanism {
    /// Response to contrast of the L, M and S cones.
    cones: [f64; 3],
    /// Largest sensitivity, by luminance.
    most: LuminanceLaw,
    /// Frequency of the largest sensitivity, by luminance.
    peak: LuminanceLaw,
    width: f64,
    area_exponent: f64,
    critical_area: f64,
    /// Below its peak the sensitivity does not fall (the chromatic mechanisms).
    low_pass: bool,
}

/// How a constant of a mechanism grows with luminance: `u (1 + v/Y)^-z`, times
/// `1 - (1 + v2/Y)^-z2` where there is a second pair.
struct LuminanceLaw {
    u: f64,
    falls: Option<[f64; 2]>,
    rises: Option<[f64; 2]>,
}

impl LuminanceLaw {
    const fn constant(u: f64) -> Self {
        Self {
            u,
            falls: None,
            rises: None,
        }
    }

    const fn of(u: f64, v: f64, z: f64) -> Self {
        Self {
            u,
            falls: Some([v, z]),
            rises: None,
        }
    }

    fn at(&self, luminance: f64) -> f64 {
        let power = |[v, z]: [f64; 2]| libm::pow(1.0 + v / luminance, -z);
        self.u * self.falls.map_or(1.0, power) * self.rises.map_or(1.0, |pair| 1.0 - power(pair))
    }
}

/// Achromatic, red-green and violet-yellow: Mantiuk et al. 2020, fitted constants.
const MECHANISMS: [Mechanism; 3] = [
    Mechanism {
        cones: [1.0, 0.256_197, 6.424_77e-7],
        most: LuminanceLaw {
            u: 356_404.0,
            falls: Some([6.2726, 0.320_031]),
            rises: Some([895_943.0, 7.779_19e-5]),
        },
        peak: LuminanceLaw::of(2.3021, 3317.45, 0.186_215),
        width: 1.075_16,
        area_exponent: 1.1107,
        critical_area: 52.9768,
        low_pass: false,
    },
    Mechanism {
        cones: [1.0, -0.933_541, 0.003_733_04],
        most: LuminanceLaw::of(423.978, 15.4032, 0.503_43),
        peak: LuminanceLaw::constant(0.122_699),
        width: 2.706_69,
        area_exponent: 1.729_03,
        critical_area: 1.384_37,
        low_pass: true,
    },
    Mechanism {
        cones: [-0.001_303_19, -1.1504, 1.0],
        most: LuminanceLaw::of(11_811.9, 196.342, 0.339_396),
        peak: LuminanceLaw::constant(7.1099e-8),
        width: 5.3416,
        area_exponent: 1.472_63,
        critical_area: 0.282_573,
        low_pass: true,
    },
];

/// Response of the L, M and S cones to one cd/m² of D65.
const D65_CONES: [f64; 3] = [0.734_734_5, 0.316_282_5, 0.020_820_0];
/// Cone response to a grey modulation of that background.
const GREY: [f64; 3] = [0.698, 0.302, 0.019_613];

impl Mechanism {
    fn sensitivity(&self, pattern: &Pattern, cone_luminance: f64) -> f64 {
        let (most, peak) = (self.most.at(cone_luminance), self.peak.at(cone_luminance));
        let decades = libm::log10(pattern.frequency) - libm::log10(peak);
        let parabola = decades * decades / (0.5 * libm::pow(2.0, self.width));
        let envelope = if self.low_pass && pattern.frequency < peak {
            most
        } else {
            most / libm::pow(10.0, parabola)
        };
        let f2 = pattern.frequency * pattern.frequency;
        let summed = libm::pow(pattern.area, self.area_exponent) * f2;
        let critical = self.critical_area + 0.65 * pattern.area;
        envelope * (summed / (critical + summed)).sqrt()
    }
}

impl Pattern {
    /// Mantiuk et al. 2020: cone contrasts through three mechanisms, summed in quadrature.
    fn grey_sensitivity(&self) -> f64 {
        let cone_luminance = self.luminance * (D65_CONES[0] + D65_CONES[1]);
        let mut contrast = [0.0; 3];
        for (c, (grey, background)) in contrast.iter_mut().zip(GREY.into_iter().zip(D65_CONES)) {
            *c = grey / (background * self.luminance);
        }
        let squared: f64 = contrast.iter().map(|c| c * c).sum();
        let energy: f64 = MECHANISMS
            .iter()
            .map(|mechanism| {
                let response: f64 = contrast
                    .iter()
                    .zip(mechanism.cones)
                    .map(|(c, w)| c * w)
                    .sum();
                let seen = response * mechanism.sensitivity(self, cone_luminance);
                seen * seen
            })
            .sum();
        (3.0 * energy / squared).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensitivity_has_the_golden_values_in_dim_and_bright_and_off_the_fovea() {
        for (f, luminance, degrees, still, flickering) in [
            (1.0, 10.0, 0.0, 121.4955, 436.156),
            (1.0, 100.0, 0.0, 111.9963, 402.055),
            (4.0, 100.0, 0.0, 56.4182, 60.3527),
            (4.0, 100.0, 10.0, 18.3348, 14.2823),
            (4.0, 1.0, 0.0, 14.8588, 15.8951),
            (8.0, 100.0, 20.0, 2.01325, 1.55340),
            (16.0, 100.0, 0.0, 5.67497, 4.19597),
            (0.5, 50.0, 0.0, 93.6047, 725.519),
            (2.0, 0.1, 5.0, 5.58026, 6.69119),
            (4.0, 100.0, 40.0, 4.41416, 3.27783),
        ] {
            let at = |hertz| sensitivity(Cpd(f), hertz, luminance, Radians::from_degrees(degrees));
            for (found, expected) in [(at(0.0), still), (at(5.0), flickering)] {
                // The constants are published to six digits, which leaves 1.5e-5.
                let case = (f, luminance, degrees);
                assert!(
                    (found / expected - 1.0).abs() < 2e-5,
                    "{case:?}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn sensitivity_above_one_cycle_falls_with_eccentricity() {
        for f in [1.0, 2.0, 4.0, 8.0, 16.0] {
            let mut before = f64::MAX;
            for degrees in 0..60 {
                let at = Radians::from_degrees(f64::from(degrees));
                let found = sensitivity(Cpd(f), 0.0, 50.0, at);
                assert!(found < before && found >= 0.0, "{f} {degrees}: {found}");
                before = found;
            }
        }
    }
}
