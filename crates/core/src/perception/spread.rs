//! How far from the gaze is a place, when the gaze itself is uncertain?

use super::sensitivity::MAGNIFICATION_DEG;
use crate::units::Radians;
use core::f64::consts::PI;

/// Rings and bearings of the quadrature over where the gaze may be.
const RINGS: u32 = 16;
const BEARINGS: u32 = 12;
/// Radius of the outermost ring's border, in standard deviations: 99 % of the gazes.
const REACH: f64 = 3.0;
/// Turn from ring to ring, so that no two rings line up: the golden section.
const TURN: f64 = 0.618_033_988_749_895;

/// The eccentricity at which the cortex gives a place what it gives on average, over a gaze that is
/// spread round its mean as a Gaussian with standard deviation `spread` on each axis.
///
/// A tracker's 1° lifts the fovea to about 1° and changes nothing in the periphery; head motion
/// alone (7°) makes the whole centre as coarse as 7°. Magnification is 1 / (e + 3.67°), Dougherty
/// et al. 2003; 192 samples. `spread` 0 gives `eccentricity` back.
#[must_use]
pub fn effective_eccentricity(eccentricity: Radians, spread: Radians) -> Radians {
    if spread.0 <= 0.0 {
        return eccentricity;
    }
    let (sin, cos) = (libm::sin(eccentricity.0), libm::cos(eccentricity.0));
    let (mut magnification, mut weight) = (0.0, 0.0);
    for ring in 0..RINGS {
        let deviations = REACH * (f64::from(ring) + 0.5) / f64::from(RINGS);
        let radius = (spread.0 * deviations).min(PI);
        let density = deviations * libm::exp(-0.5 * deviations * deviations);
        weight += density * f64::from(BEARINGS);
        let turn = f64::from(ring) * TURN;
        for bearing in 0..BEARINGS {
            let bearing = 2.0 * PI * (f64::from(bearing) + turn) / f64::from(BEARINGS);
            let across = sin * libm::sin(radius) * libm::cos(bearing);
            let between = libm::acos((cos * libm::cos(radius) + across).clamp(-1.0, 1.0));
            magnification += density / (Radians(between).to_degrees() + MAGNIFICATION_DEG);
        }
    }
    let mean = magnification / weight;
    Radians::from_degrees((1.0 / mean - MAGNIFICATION_DEG).max(0.0))
}

/// Places of a [`SpreadTable`], spaced as the roots of eccentricity.
const PLACES: usize = 128;

/// Effective eccentricities under one spread, looked up; off by less than 0.02° up to 120°.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadTable {
    effective: Option<Vec<f64>>,
}

impl SpreadTable {
    /// The table of a spread. Costs about a millisecond; nothing without spread.
    #[must_use]
    pub fn new(spread: Radians) -> Self {
        let entry = |k: usize| {
            let root = k as f64 / (PLACES - 1) as f64;
            effective_eccentricity(Radians(PI * root * root), spread).0
        };
        Self {
            effective: (spread.0 > 0.0).then(|| (0..PLACES).map(entry).collect()),
        }
    }

    /// See [`effective_eccentricity`].
    #[must_use]
    pub fn effective(&self, eccentricity: Radians) -> Radians {
        let Some(effective) = &self.effective else {
            return eccentricity;
        };
        let at = (eccentricity.0 / PI).clamp(0.0, 1.0).sqrt() * (PLACES - 1) as f64;
        let before = (at as usize).min(PLACES - 2);
        let [a, b] = [effective[before], effective[before + 1]];
        Radians(a + (at - before as f64) * (b - a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effective(eccentricity_deg: f64, spread_deg: f64) -> f64 {
        let degrees = Radians::from_degrees;
        effective_eccentricity(degrees(eccentricity_deg), degrees(spread_deg)).to_degrees()
    }

    #[test]
    fn the_table_says_what_the_quadrature_says() {
        for spread in [0.0, 0.5, 1.5, 7.0] {
            let table = SpreadTable::new(Radians::from_degrees(spread));
            for step in 0..400 {
                let degrees = f64::from(step) * 0.3;
                let found = table.effective(Radians::from_degrees(degrees)).to_degrees();
                assert!(
                    (found - effective(degrees, spread)).abs() < 0.02,
                    "{spread} {degrees}"
                );
            }
        }
    }

    #[test]
    fn a_certain_gaze_has_the_eccentricity_itself() {
        for degrees in [0.0, 0.1, 5.0, 90.0, 180.0] {
            assert!((effective(degrees, 0.0) - degrees).abs() < 1e-12);
            assert!((effective(degrees, 1e-4) - degrees).abs() < 1e-3);
        }
    }

    #[test]
    fn spread_coarsens_the_fovea_and_leaves_the_periphery() {
        let mut before = 0.0;
        for spread in [0.5, 1.0, 2.0, 7.0, 13.0] {
            let fovea = effective(0.0, spread);
            assert!(fovea > before && fovea > 0.8 * spread && fovea < 1.4 * spread);
            before = fovea;
        }
        assert!((effective(40.0, 2.0) - 40.0).abs() < 0.2);
    }

    #[test]
    fn what_lies_farther_out_stays_farther_out() {
        for spread in [0.2, 1.0, 2.0, 7.0, 13.0] {
            let mut before = -1.0;
            for step in 0..400 {
                let found = effective(f64::from(step) * 0.25, spread);
                assert!(found > before, "{spread} {step}: {found} {before}");
                before = found;
            }
        }
    }
}
