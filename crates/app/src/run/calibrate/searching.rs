//! At which bounds is a content judged, and which rows are kept?
//!
//! The first comes from constants; each further one lies where those before predict a score that
//! is still to be found.

use super::measures::{CalibrationExtent, FoundAtBound};
use foveal_core::content::policy::calibration::{Expectation, slope_for};
use foveal_core::content::video::calibration::{CalibrationRow, ZONES};
use foveal_core::perception::visible_loss::{BEST_JOD, JOD_EXPONENT};

/// The scores that are looked for, the default target first, then one that encloses it.
const WANTED: [f64; 4] = [9.5, 9.75, 9.0, 9.3];
/// How near to one of them a score counts as found, in JOD.
const FOUND_WITHIN: f64 = 0.12;
/// How many values are tried at most: bounds, and slopes.
const USUAL: [usize; 2] = [5, 4];
const THOROUGH: [usize; 2] = [8, 8];
/// How the score that is lost grows with the slope, as an exponent: from the constants of core.
const SLOPE_EXPONENT: f64 = 1.25;
/// Values that are tried: of bounds, and of slopes.
const BOUNDS: [f64; 2] = [1e-2, 1e6];
const SLOPES: [f64; 2] = [0.0015, 0.35];
/// A finer value that gains no more than this, in JOD, is as fine as the content goes.
const NO_GAIN: f64 = 0.02;
/// Below this, in JOD, it does not matter how little is lost.
const NEXT_TO_NOTHING: f64 = 0.02;
/// The bound that is tried first: about what 9.5 JOD needs for most content.
const FIRST_BOUND: f64 = 400.0;
/// Steps are at most by this factor.
const MOST_STEP: f64 = 8.0;

/// Looks for the bounds of one rule at one density.
pub(super) struct Search {
    rule: Expectation,
    most: usize,
    found: Vec<(f64, FoundAtBound)>,
}

impl Search {
    pub(super) fn new(rule: Expectation, extent: CalibrationExtent) -> Self {
        let [bounds, slopes] = match extent {
            CalibrationExtent::Usual => USUAL,
            CalibrationExtent::Thorough => THOROUGH,
        };
        Self {
            rule,
            most: match rule {
                Expectation::ByLoss => bounds,
                Expectation::Elsewise => slopes,
            },
            found: Vec::new(),
        }
    }

    /// The next value to be judged; `None` where nothing is left to be found.
    pub(super) fn next(&self) -> Option<f64> {
        if self.found.is_empty() {
            return Some(match self.rule {
                Expectation::ByLoss => FIRST_BOUND,
                Expectation::Elsewise => slope_for(WANTED[0]),
            });
        }
        if self.found.len() >= self.most {
            return None;
        }
        let is_missing = |wanted: &f64| {
            let is_near = |(_, found): &(f64, FoundAtBound)| {
                (mean(&found.jods) - wanted).abs() <= FOUND_WITHIN
            };
            !self.found.iter().any(is_near)
        };
        let is_new = |value: &f64| {
            let is_known = |(known, _): &(f64, FoundAtBound)| (value / known - 1.0).abs() < 0.03;
            !self.found.iter().any(is_known)
        };
        let missing = WANTED.into_iter().filter(is_missing);
        let missing = missing.filter(|wanted| self.may_reach(*wanted));
        missing.map(|wanted| self.value_for(wanted)).find(is_new)
    }

    /// Whether finer values may still score this: not where the two finest score alike.
    fn may_reach(&self, wanted: f64) -> bool {
        match self.found.as_slice() {
            [(_, finest), (_, next), ..] => {
                let [finest, next] = [mean(&finest.jods), mean(&next.jods)];
                wanted <= finest || finest - next > NO_GAIN
            }
            _ => true,
        }
    }

    pub(super) fn learn(&mut self, value: f64, found: FoundAtBound) {
        self.found.push((value, found));
        self.found.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    pub(super) fn found(self) -> Vec<(f64, FoundAtBound)> {
        self.found
    }

    /// The value at which a score is expected after what was found: between two along logarithms,
    /// else from the nearest on by a law.
    fn value_for(&self, wanted: f64) -> f64 {
        let asked = (BEST_JOD - wanted).ln();
        let points = self.found.iter().map(|(value, found)| {
            let lost = BEST_JOD - mean(&found.jods);
            [value.ln(), lost.max(NEXT_TO_NOTHING).ln()]
        });
        let (below, above): (Vec<[f64; 2]>, Vec<[f64; 2]>) =
            points.partition(|point| point[1] < asked);
        let (exponent, [least, most]) = match self.rule {
            Expectation::ByLoss => (JOD_EXPONENT, BOUNDS),
            Expectation::Elsewise => (SLOPE_EXPONENT, SLOPES),
        };
        let by_law = |point: &[f64; 2]| point[0] + (asked - point[1]) / exponent;
        let ln_value = match (below.last(), above.first()) {
            (Some(low), Some(high)) if low[1] > NEXT_TO_NOTHING.ln() => {
                let share = (asked - low[1]) / (high[1] - low[1]);
                low[0] + share * (high[0] - low[0])
            }
            // Where almost nothing is lost, how little says nothing about what lies beyond.
            (Some(low), Some(high)) => by_law(high).max(low[0] + 0.3 * (high[0] - low[0])),
            (Some(low), None) => by_law(low).min(low[0] + MOST_STEP.ln()),
            (None, Some(high)) => by_law(high).max(high[0] - MOST_STEP.ln()),
            (None, None) => 0.0,
        };
        ln_value.exp().clamp(least, most)
    }
}

/// The rows of what was found, as the table holds them: scores that fall while bounds rise.
pub(super) fn rows_of(
    rule: Expectation,
    ppd: f64,
    found: Vec<(f64, FoundAtBound)>,
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
