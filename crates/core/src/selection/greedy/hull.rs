//! How far should a unit go to get the most value per byte?

use super::catalog::Catalog;
use super::rule::{Chain, Reach};

/// The bytes and values of one unit's steps, finest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve<'a> {
    pub(super) chain: Chain,
    /// Level that is held and costs nothing.
    pub(super) held: u8,
    pub(super) bytes: &'a [u32],
    pub(super) value: &'a [f64],
}

/// A step over one level or several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    pub(super) to: u8,
    pub(super) bytes: u64,
    pub(super) value: f64,
}

/// Value per byte, W of Chen et al. 2022, Eq. 6. What is free and has value is infinitely dense;
/// free and worthless gives NaN, which is greater than no number.
pub(super) fn density(value: f64, bytes: u64) -> f64 {
    // Sums of bytes stay far below 2^63, and signed numbers convert in one instruction.
    value / (bytes as i64) as f64
}

impl Curve<'_> {
    /// The next step from a level: to the next corner of the upper convex hull of what costs no
    /// more than `most` bytes, which is where the slope is greatest; the nearest of equals. Nothing
    /// where no step has a positive value.
    pub(super) fn next(&self, from: u8, reach: Reach, most: u64) -> Option<Segment> {
        let mut best = None;
        let mut greatest = 0.0;
        let segments = self.segments(from, reach);
        for segment in segments.filter(|segment| segment.bytes <= most) {
            let slope = density(segment.value, segment.bytes);
            if slope > greatest {
                greatest = slope;
                best = Some(segment);
            }
        }
        best
    }

    /// The greatest slope from a level, which is that of [`Self::next`]; 0 where no step has a
    /// positive value. No branch: which step is best cannot be predicted.
    pub(super) fn steepest(&self, from: u8, reach: Reach) -> f64 {
        self.segments(from, reach).fold(0.0, |greatest, segment| {
            let slope = density(segment.value, segment.bytes);
            if slope > greatest { slope } else { greatest }
        })
    }

    /// The steps from a level to every finer one within reach, nearest first.
    pub(super) fn segments(&self, from: u8, reach: Reach) -> impl Iterator<Item = Segment> {
        let last = match reach {
            Reach::Hull => 0,
            Reach::Level => from.saturating_sub(1),
        };
        let steps = usize::from(last)..usize::from(from);
        let steps = self.bytes[steps.clone()]
            .iter()
            .zip(&self.value[steps])
            .rev();
        let replaced = match self.chain {
            Chain::Refining => None,
            Chain::Replacing => Some(self.replaced_bytes(from)),
        };
        let mut so_far = Segment {
            to: from,
            bytes: 0,
            value: 0.0,
        };
        steps.map(move |(bytes, value)| {
            let own = u64::from(*bytes);
            so_far.to -= 1;
            so_far.value += value;
            so_far.bytes = match replaced {
                None => so_far.bytes + own,
                Some(replaced) => own.saturating_sub(replaced),
            };
            so_far
        })
    }

    /// The step from a level to a finer one.
    pub(super) fn segment(&self, from: u8, to: u8) -> Segment {
        let nothing = Segment {
            to,
            bytes: 0,
            value: 0.0,
        };
        self.segments(from, Reach::Hull)
            .find(|segment| segment.to == to)
            .unwrap_or(nothing)
    }

    /// Bytes that fall away when a finer level takes the place of one chosen but not yet held.
    fn replaced_bytes(&self, from: u8) -> u64 {
        let chosen = usize::from(from);
        if from == self.held || chosen >= self.bytes.len() {
            return 0;
        }
        u64::from(self.bytes[chosen])
    }
}

impl Catalog {
    /// Rebuilds what is cached for the units that changed and returns how many those were; without
    /// it the next selection does. About 5 ns a step.
    pub fn refresh(&mut self) -> usize {
        let stale = core::mem::take(&mut self.stale);
        for unit in &stale {
            let steepest = self
                .curve(*unit)
                .steepest(self.level(*unit), self.rule.reach);
            self.density[*unit as usize] = steepest;
            self.is_stale[*unit as usize] = false;
        }
        let count = stale.len();
        // Keep the allocation for the next change.
        self.stale = stale;
        self.stale.clear();
        count
    }

    /// The bytes and values of a unit.
    pub(super) fn curve(&self, unit: u32) -> Curve<'_> {
        let steps = self.steps(unit);
        Curve {
            chain: self.chain[unit as usize],
            held: self.level(unit),
            bytes: &self.bytes[steps.clone()],
            value: &self.value[steps],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve<'a>(chain: Chain, bytes: &'a [u32], value: &'a [f64]) -> Curve<'a> {
        let held = bytes.len() as u8;
        Curve {
            chain,
            held,
            bytes,
            value,
        }
    }

    fn corners(curve: &Curve<'_>) -> Vec<Segment> {
        let mut corners = Vec::new();
        let mut from = curve.held;
        while let Some(segment) = curve.next(from, Reach::Hull, u64::MAX) {
            from = segment.to;
            corners.push(segment);
        }
        corners
    }

    proptest! {
        #[test]
        fn no_level_lies_above_the_hull_and_its_slopes_fall(
            steps in proptest::collection::vec((1u32..1000, -5.0f64..20.0), 1..9),
        ) {
            let (bytes, value): (Vec<u32>, Vec<f64>) = steps.into_iter().unzip();
            let curve = curve(Chain::Refining, &bytes, &value);
            let corners = corners(&curve);
            prop_assert_eq!(
                curve.steepest(curve.held, Reach::Hull),
                corners.first().map_or(0.0, |corner| density(corner.value, corner.bytes))
            );
            let slopes: Vec<f64> =
                corners.iter().map(|corner| density(corner.value, corner.bytes)).collect();
            prop_assert!(slopes.windows(2).all(|pair| pair[0] >= pair[1] - 1e-9));
            for point in curve.segments(curve.held, Reach::Hull) {
                // The hull as the most value for so many bytes, fractions of a step allowed.
                let (mut left, mut most) = (point.bytes as f64, 0.0);
                for corner in &corners {
                    let share = (left / corner.bytes as f64).min(1.0);
                    most += share * corner.value;
                    left -= share * corner.bytes as f64;
                }
                prop_assert!(point.value <= most + 1e-9);
            }
        }
    }

    #[test]
    fn a_poor_step_is_taken_together_with_the_rich_one_behind_it() {
        let curve = curve(Chain::Refining, &[10, 10], &[30.0, 1.0]);
        let both = Segment {
            to: 0,
            bytes: 20,
            value: 31.0,
        };
        assert_eq!(corners(&curve), [both]);
        let one = curve.next(2, Reach::Level, 20);
        assert_eq!(
            one,
            Some(Segment {
                to: 1,
                bytes: 10,
                value: 1.0
            })
        );
    }

    #[test]
    fn a_finer_level_that_replaces_a_chosen_one_costs_the_difference() {
        let curve = curve(Chain::Replacing, &[40, 10], &[6.0, 5.0]);
        let expected = [(1, 10, 5.0), (0, 30, 6.0)];
        let expected = expected.map(|(to, bytes, value)| Segment { to, bytes, value });
        assert_eq!(corners(&curve), expected);
        let held = Curve { held: 1, ..curve };
        assert_eq!(
            held.next(1, Reach::Hull, 40).map(|segment| segment.bytes),
            Some(40)
        );
    }

    #[test]
    fn what_is_free_comes_first_and_what_is_worthless_never() {
        assert_eq!(density(1.0, 0), f64::INFINITY);
        assert!(density(0.0, 0).is_nan());
        assert_eq!(density(-1.0, 0), f64::NEG_INFINITY);
        let worthless = curve(Chain::Refining, &[0, 5], &[0.0, -1.0]);
        assert_eq!(corners(&worthless), []);
    }
}
