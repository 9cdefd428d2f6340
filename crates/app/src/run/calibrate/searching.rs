//! At which bounds is a content judged, and what is told of them?
//!
//! The first comes from constants; each further one lies where those before foretell a score that
//! is still to be found.

use super::{Extent, Found};
use foveal_core::content::calibration::{Expectation, slope_for};
use foveal_core::content::video::calibration::{CalibrationRow, ZONES};
use foveal_core::perception::visible_loss::{BEST_JOD, JOD_EXPONENT};

/// The scores that are looked for, in this order; the first twice, as the first guess is rough.
const WANTED: [f64; 5] = [9.5, 9.5, 9.0, 9.75, 9.3];
/// How many of them, by bound and by slope.
const USUAL: [usize; 2] = [4, 3];
const THOROUGH: [usize; 2] = [5, 5];
/// How the score that is lost grows with the slope, as an exponent: from the constants of core.
const SLOPE_EXPONENT: f64 = 1.25;
/// The least that counts as lost, in JOD.
const LEAST_LOST: f64 = 0.02;
/// Steps are at most by this factor.
const MOST_STEP: f64 = 16.0;

/// Looks for the bounds of one rule at one density.
pub(super) struct Search {
    rule: Expectation,
    wanted: &'static [f64],
    found: Vec<(f64, Found)>,
}

impl Search {
    pub(super) fn new(rule: Expectation, extent: Extent) -> Self {
        let counts = match extent {
            Extent::Usual => USUAL,
            Extent::Thorough => THOROUGH,
        };
        let count = match rule {
            Expectation::ByLoss => counts[0],
            Expectation::Elsewise => counts[1],
        };
        Self {
            rule,
            wanted: &WANTED[..count],
            found: Vec::new(),
        }
    }

    /// The next value to be judged.
    pub(super) fn next(&self) -> Option<f64> {
        let wanted = *self.wanted.get(self.found.len())?;
        if self.found.is_empty() {
            return Some(match self.rule {
                Expectation::ByLoss => self.rule.told(wanted),
                Expectation::Elsewise => slope_for(wanted),
            });
        }
        let value = self.value_for(wanted);
        // What was judged already tells nothing new.
        let is_known = |known: f64| (value / known - 1.0).abs() < 0.02;
        match self.found.iter().any(|(known, _)| is_known(*known)) {
            true => Some(value * 0.5),
            false => Some(value),
        }
    }

    pub(super) fn learn(&mut self, value: f64, found: Found) {
        self.found.push((value, found));
        self.found.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    pub(super) fn found(self) -> Vec<(f64, Found)> {
        self.found
    }

    /// The value at which a score is expected after what was found.
    fn value_for(&self, wanted: f64) -> f64 {
        let ln_lost = |jod: f64| (BEST_JOD - jod).max(LEAST_LOST).ln();
        let points = self.found.iter();
        let points: Vec<[f64; 2]> = points
            .map(|(value, found)| [value.ln(), ln_lost(mean(&found.jods))])
            .collect();
        let asked = ln_lost(wanted);
        let exponent = match self.rule {
            Expectation::ByLoss => JOD_EXPONENT,
            Expectation::Elsewise => SLOPE_EXPONENT,
        };
        let around = points.windows(2).find(|pair| {
            (pair[0][1] - asked) * (pair[1][1] - asked) <= 0.0 && pair[0][1] < pair[1][1]
        });
        let ln_value = match around {
            Some(pair) => {
                let share = (asked - pair[0][1]) / (pair[1][1] - pair[0][1]);
                pair[0][0] + share * (pair[1][0] - pair[0][0])
            }
            None => {
                let off = |point: &[f64; 2]| (point[1] - asked).abs();
                let nearest = points.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
                let nearest = nearest.copied().unwrap_or_default();
                let most = MOST_STEP.ln();
                nearest[0] + ((asked - nearest[1]) / exponent).clamp(-most, most)
            }
        };
        ln_value.exp()
    }
}

/// The rows of what was found, as the table tells them: scores that fall while bounds rise.
pub(super) fn rows_of(
    rule: Expectation,
    ppd: f64,
    found: Vec<(f64, Found)>,
) -> Vec<CalibrationRow> {
    let parts = [None].into_iter().chain((0..ZONES).map(Some));
    let rows = parts.flat_map(|zone| {
        let rows = found.iter().filter_map(|(value, found)| {
            let jods = match zone {
                None => &found.jods,
                Some(zone) => &found.zones[zone],
            };
            let loss = match zone {
                None => found.losses.whole(),
                Some(zone) => found.losses.zone(zone)?,
            };
            let row = CalibrationRow {
                rule,
                ppd,
                zone,
                bound: match rule {
                    Expectation::ByLoss => *value,
                    Expectation::Elsewise => found.losses.whole(),
                },
                loss,
                jod_mean: (!jods.is_empty()).then(|| mean(jods))?,
                jod_sd: deviation(jods),
                pixels_share: mean(&found.shares),
                bytes: mean(&found.bytes).round() as u64,
            };
            Some(row.as_told())
        });
        falling(rows.collect())
    });
    rows.collect()
}

/// Without what noise and rounding turn round: a score never rises with the bound, a loss never
/// falls, and of equal bounds the first counts.
fn falling(mut rows: Vec<CalibrationRow>) -> Vec<CalibrationRow> {
    rows.sort_by(|a, b| a.bound.total_cmp(&b.bound));
    rows.dedup_by(|later, first| later.bound <= first.bound);
    rows.retain(|row| row.bound > 0.0);
    for k in 1..rows.len() {
        rows[k].jod_mean = rows[k].jod_mean.min(rows[k - 1].jod_mean);
        rows[k].loss = rows[k].loss.max(rows[k - 1].loss);
    }
    rows
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn deviation(values: &[f64]) -> f64 {
    let middle = mean(values);
    let squares = values.iter().map(|value| (value - middle).powi(2));
    (squares.sum::<f64>() / values.len().max(1) as f64).sqrt()
}
