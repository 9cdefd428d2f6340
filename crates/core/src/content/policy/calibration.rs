//! Which score is to be expected of what a model of the eye loses?
//!
//! Fitted by `foveal evaluate targets --frames 8` on generated scenes of seeds 1 to 8; the same
//! command prints how the fit holds on others
//! (docs/decisions/0013-levels-are-chosen-for-a-score.md).

use crate::perception::visible_loss::BEST_JOD;

/// How levels were chosen, as far as signatures predict what is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// By signatures: what they miss is then shown coarse.
    ByLoss,
    /// By anything else.
    Elsewise,
}

/// Pairs of a score and the quality difference from signatures at which it is reached, scores
/// rising: three quarters of what the fit finds on average, so that most content has the score.
const TOLD_BY_LOSS: [[f64; 2]; 5] = [
    [8.0, 3950.0],
    [8.5, 2260.0],
    [9.0, 900.0],
    [9.5, 152.0],
    [9.8, 45.0],
];
/// The same for what is chosen elsewise: half of the fit, as content differs more.
const TOLD_ELSEWISE: [[f64; 2]; 5] = [
    [8.0, 7200.0],
    [8.5, 4100.0],
    [9.0, 1250.0],
    [9.5, 240.0],
    [9.8, 60.0],
];

/// Pairs of a score and the slope of the linear model, in degrees of a pixel a degree of
/// eccentricity, at which content of unknown texture has it; scores rising. Nine tenths of the fit.
const SLOPES: [[f64; 2]; 5] = [
    [8.0, 0.028],
    [8.5, 0.019],
    [9.0, 0.013],
    [9.5, 0.0075],
    [9.8, 0.0045],
];

impl Expectation {
    fn pairs(self) -> [[f64; 2]; 5] {
        match self {
            Self::ByLoss => TOLD_BY_LOSS,
            Self::Elsewise => TOLD_ELSEWISE,
        }
    }

    /// The score to expect for a quality difference computed from signatures.
    #[must_use]
    pub fn jod(self, told: f64) -> f64 {
        if told <= 0.0 {
            return BEST_JOD;
        }
        let pairs = self
            .pairs()
            .map(|[jod, told]| [ln(told), ln(BEST_JOD - jod)]);
        BEST_JOD - libm::exp(along(&pairs, ln(told)))
    }

    /// The quality difference, from signatures, at which a score below 10 is expected: the inverse
    /// of [`Self::jod`].
    #[must_use]
    pub fn told(self, target: f64) -> f64 {
        let pairs = self
            .pairs()
            .map(|[jod, told]| [ln(BEST_JOD - jod), ln(told)]);
        libm::exp(along(&pairs, ln(BEST_JOD - target)))
    }
}

/// The slope by which content of unknown texture keeps a score below 10.
#[must_use]
pub fn slope_for(target: f64) -> f64 {
    let pairs = SLOPES.map(|[jod, slope]| [ln(BEST_JOD - jod), ln(slope)]);
    libm::exp(along(&pairs, ln(BEST_JOD - target)))
}

fn ln(value: f64) -> f64 {
    libm::log(value)
}

/// The polyline through `pairs`, whose x fall or rise, and beyond its ends the straight line of the
/// last two.
fn along(pairs: &[[f64; 2]], x: f64) -> f64 {
    let is_before = |pair: &&[[f64; 2]]| (pair[0][0] - x) * (pair[1][0] - x) <= 0.0;
    let falls = pairs[0][0] > pairs[pairs.len() - 1][0];
    let is_first = (x > pairs[0][0]) == falls;
    let ends = if is_first {
        &pairs[..2]
    } else {
        &pairs[pairs.len() - 2..]
    };
    let [[x0, y0], [x1, y1]] = match pairs.windows(2).find(is_before).unwrap_or(ends) {
        [from, to] => [*from, *to],
        _ => return 0.0,
    };
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expectations_fall_with_what_is_lost_and_are_undone_by_their_inverse() {
        for expectation in [Expectation::ByLoss, Expectation::Elsewise] {
            let mut before = BEST_JOD;
            for step in 0..60 {
                let told = libm::exp2(f64::from(step) / 3.0 - 4.0);
                let jod = expectation.jod(told);
                assert!(jod < before, "{told}: {jod}");
                let back = expectation.told(jod);
                assert!((back / told - 1.0).abs() < 1e-9, "{told}");
                before = jod;
            }
            assert_eq!(expectation.jod(0.0), BEST_JOD);
        }
    }

    #[test]
    fn a_higher_score_takes_a_smaller_slope() {
        let slopes = [6.0, 8.5, 9.0, 9.3, 9.5, 9.75, 9.95].map(slope_for);
        assert!(
            slopes.windows(2).all(|pair| pair[1] < pair[0]),
            "{slopes:?}"
        );
        assert!((slope_for(SLOPES[3][0]) / SLOPES[3][1] - 1.0).abs() < 1e-9);
    }
}
