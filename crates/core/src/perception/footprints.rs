//! Where in the view does each unit refine what is drawn, or what is it worth there?
//!
//! Measured in the picture that is on screen, so that what is hidden counts nothing. A GPU measures
//! it, and no two of them draw the same: it is an input of selection, and lies in the log.

use crate::pack::unit::UnitId;
use crate::units::Radians;
use core::cmp::Ordering;

/// Parts of a degree that eccentricities are written in.
pub const PARTS_OF_DEGREE: f64 = 16.0;
/// Parts of a square degree that areas are written in.
pub const PARTS_OF_DEG2: f64 = 1024.0;

/// The part of the view that a unit would refine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// The unit.
    pub unit: UnitId,
    /// What of the view it is, in 1024ths of a square degree at the eye.
    pub area: u32,
    /// Least angle to the gaze, in sixteenths of a degree.
    pub least: u32,
    /// Mean angle to the gaze, in sixteenths of a degree.
    pub mean: u32,
}

impl Footprint {
    /// What of the view it is, in square degrees at the eye.
    #[must_use]
    pub fn area_deg2(&self) -> f64 {
        f64::from(self.area) / PARTS_OF_DEG2
    }

    /// Least and mean angle to the gaze.
    #[must_use]
    pub fn eccentricities(&self) -> [Radians; 2] {
        let angle = |parts: u32| Radians::from_degrees(f64::from(parts) / PARTS_OF_DEGREE);
        [angle(self.least), angle(self.mean)]
    }
}

/// The footprints of all units that would refine something in view, in the order of units.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Footprints {
    list: Vec<Footprint>,
}

impl Footprints {
    /// These footprints; of several of one unit, as two views have them, the larger one, and the
    /// smaller angles.
    #[must_use]
    pub fn new(mut list: Vec<Footprint>) -> Self {
        list.retain(|it| it.area > 0);
        list.sort_unstable_by_key(|it| it.unit);
        list.dedup_by(|other, kept| {
            let is_same = other.unit == kept.unit;
            if is_same {
                kept.area = kept.area.max(other.area);
                kept.least = kept.least.min(other.least);
                kept.mean = kept.mean.min(other.mean);
            }
            is_same
        });
        Self { list }
    }

    /// Each of them, in the order of units.
    #[must_use]
    pub fn list(&self) -> &[Footprint] {
        &self.list
    }

    /// What differs from `before`, as a log records it: for each unit that changed four
    /// numbers, its distance from the one listed before (from 0 at first), area, least and mean
    /// angle; an area of 0 where it is gone.
    #[must_use]
    pub fn since(&self, before: &Self) -> Vec<u32> {
        let (mut now, mut then) = (self.list.iter().peekable(), before.list.iter().peekable());
        let (mut told, mut last) = (Vec::new(), 0);
        loop {
            let order = match (now.peek(), then.peek()) {
                (None, None) => return told,
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (Some(now), Some(then)) => now.unit.cmp(&then.unit),
            };
            let gone = |it: &Footprint| Footprint {
                unit: it.unit,
                ..Footprint::default()
            };
            let changed = match order {
                Ordering::Less => now.next().copied(),
                Ordering::Greater => then.next().map(gone),
                Ordering::Equal => now.next().zip(then.next()).and_then(|(now, then)| {
                    let is_other = now != then;
                    is_other.then_some(*now)
                }),
            };
            if let Some(Footprint {
                unit: UnitId(unit),
                area,
                least,
                mean,
            }) = changed
            {
                told.extend([unit - last, area, least, mean]);
                last = unit;
            }
        }
    }

    /// The footprints for which [`Self::since`] this returned such changes.
    ///
    /// # Errors
    /// These are no changes: the reason.
    pub fn after(&self, changes: &[u32]) -> Result<Self, String> {
        let (changes, rest) = changes.as_chunks::<4>();
        if !rest.is_empty() {
            return Err("found numbers left over, expected four for each unit".to_owned());
        }
        let mut last = 0_u32;
        let mut list = Vec::with_capacity(self.list.len() + changes.len());
        let mut kept = self.list.iter().peekable();
        for (place, [gap, area, least, mean]) in changes.iter().enumerate() {
            let unit = last.checked_add(*gap).filter(|_| place == 0 || *gap > 0);
            let Some(unit) = unit else {
                return Err(format!("found a distance of {gap} after unit {last}"));
            };
            last = unit;
            while let Some(before) = kept.next_if(|it| it.unit < UnitId(unit)) {
                list.push(*before);
            }
            kept.next_if(|it| it.unit == UnitId(unit));
            if *area > 0 {
                list.push(Footprint {
                    unit: UnitId(unit),
                    area: *area,
                    least: *least,
                    mean: *mean,
                });
            }
        }
        list.extend(kept);
        Ok(Self { list })
    }
}

/// What was measured of the units of an asset.
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// What parts of the view they would refine.
    Footprints(Footprints),
    /// What they are worth, of those that are worth something, in the order of units: visible error
    /// that each removes, in thresholds times square degrees, by pictures of all levels.
    Worths(Vec<(UnitId, f32)>),
}

impl Default for Measured {
    fn default() -> Self {
        Self::Footprints(Footprints::default())
    }
}

impl Measured {
    /// What units are worth, by their numbers.
    #[must_use]
    pub fn worths(worths: &[f64]) -> Self {
        let worths = (0..).map(UnitId).zip(worths);
        let worths = worths.map(|(unit, worth)| (unit, *worth as f32));
        Self::Worths(worths.filter(|(_, worth)| *worth > 0.0).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_footprints() -> impl Strategy<Value = Footprints> {
        let any = (0_u32..60, 0_u32..3, 0_u32..3, 0_u32..3);
        let footprint = any.prop_map(|(unit, area, least, mean)| Footprint {
            unit: UnitId(unit),
            area,
            least,
            mean,
        });
        prop::collection::vec(footprint, 0..40).prop_map(Footprints::new)
    }

    proptest! {
        #[test]
        fn changes_lead_from_any_footprints_to_any_others(
            before in any_footprints(), now in any_footprints(),
        ) {
            prop_assert_eq!(before.after(&now.since(&before)), Ok(now.clone()));
            prop_assert_eq!(now.since(&now), Vec::<u32>::new());
        }

        #[test]
        fn any_numbers_are_changes_or_refused(
            before in any_footprints(), numbers in prop::collection::vec(0_u32..9, 0..30),
        ) {
            if let Ok(after) = before.after(&numbers) {
                let units: Vec<UnitId> = after.list().iter().map(|it| it.unit).collect();
                prop_assert!(units.is_sorted_by(|a, b| a < b));
            }
        }
    }

    #[test]
    fn what_two_views_show_is_told_once() {
        let of = |area, least| Footprint {
            unit: UnitId(4),
            area,
            least,
            mean: 9,
        };
        let both = Footprints::new(vec![of(7, 3), of(9, 5), of(0, 0)]);
        assert_eq!(both.list(), [of(9, 3)]);
    }
}
