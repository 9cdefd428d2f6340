//! What can be raised, and at what cost?

use super::rule::{Chain, Rule};

/// Largest absolute value of a step: sums over any chain stay finite.
const LARGEST_VALUE: f64 = 1e300;

/// One step of a unit, from the next coarser level to the level that it is listed for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Bytes to fetch; 0 is free and comes first.
    pub bytes: u32,
    /// What the step is worth over the next coarser level. NaN counts as 0, and what is beyond
    /// ±1e300 as ±1e300.
    pub value: f64,
}

/// A unit at a level or finer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rung {
    /// Number of the unit in the catalog.
    pub unit: u32,
    /// The coarsest level that will do.
    pub level: u8,
}

/// Units with their levels, bytes and values, and what of them is held.
///
/// About 30 bytes a unit and 12 a step (16 where there are prerequisites), all in flat arrays.
#[derive(Clone, Debug)]
pub struct Catalog {
    pub(super) rule: Rule,
    /// First step of each unit in the arrays of steps, and their number at the end.
    pub(super) first: Vec<u32>,
    pub(super) chain: Vec<Chain>,
    pub(super) held: Vec<u8>,
    pub(super) bytes: Vec<u32>,
    pub(super) value: Vec<f64>,
    /// First prerequisite of each step, and their number at the end; empty where nothing has any.
    pub(super) first_needed: Vec<u32>,
    pub(super) needed: Vec<Rung>,
    /// Fewest bytes of any step.
    pub(super) least_bytes: u32,
    /// Value per byte of each unit's first offer, 0 where there is none: the cached hulls.
    pub(super) density: Vec<f64>,
    pub(super) is_stale: Vec<bool>,
    pub(super) stale: Vec<u32>,
}

impl Catalog {
    /// Number of units.
    #[must_use]
    pub fn units(&self) -> u32 {
        self.held.len() as u32
    }

    /// The coarsest level of a unit, which is always held: its number of steps.
    ///
    /// # Panics
    /// When there is no such unit.
    #[must_use]
    pub fn coarsest(&self, unit: u32) -> u8 {
        let at = unit as usize;
        (self.first[at + 1] - self.first[at]) as u8
    }

    /// The level of a unit that is held.
    ///
    /// # Panics
    /// When there is no such unit.
    #[must_use]
    pub fn level(&self, unit: u32) -> u8 {
        self.held[unit as usize]
    }

    /// Says what a unit's steps are worth now, finest first: `values[l]` is the gain of level `l`
    /// over the next coarser one. Only units whose values changed are looked at again.
    ///
    /// # Panics
    /// When there is no such unit, or it has another number of steps.
    pub fn set_values(&mut self, unit: u32, values: &[f64]) {
        let steps = self.steps(unit);
        assert_eq!(values.len(), steps.len(), "one value for every step");
        let mut changed = false;
        for (old, new) in self.value[steps].iter_mut().zip(values) {
            let new = counted(*new);
            changed |= *old != new;
            *old = new;
        }
        if changed {
            self.mark(unit);
        }
    }

    /// Says what a unit's steps cost now, finest first: other frames have other bytes.
    ///
    /// # Panics
    /// When there is no such unit, or it has another number of steps.
    pub fn set_bytes(&mut self, unit: u32, bytes: &[u32]) {
        let steps = self.steps(unit);
        assert_eq!(bytes.len(), steps.len(), "bytes for every step");
        if self.bytes[steps.clone()] != *bytes {
            self.bytes[steps].copy_from_slice(bytes);
            let least = bytes.iter().copied().min().unwrap_or(u32::MAX);
            self.least_bytes = self.least_bytes.min(least);
            self.mark(unit);
        }
    }

    /// Says which level of a unit is held now: bytes have arrived, or were dropped.
    ///
    /// # Panics
    /// When there is no such unit or level.
    pub fn set_level(&mut self, unit: u32, level: u8) {
        assert!(level <= self.coarsest(unit), "a unit is held at its levels");
        if self.held[unit as usize] != level {
            self.held[unit as usize] = level;
            self.mark(unit);
        }
    }

    /// Places of a unit's steps in the arrays of steps.
    pub(super) fn steps(&self, unit: u32) -> core::ops::Range<usize> {
        let at = unit as usize;
        self.first[at] as usize..self.first[at + 1] as usize
    }

    /// What a step needs besides the coarser levels of its own unit.
    pub(super) fn prerequisites(&self, stage: Rung) -> &[Rung] {
        if self.needed.is_empty() {
            return &[];
        }
        let step = self.first[stage.unit as usize] as usize + usize::from(stage.level);
        let [from, to] = [step, step + 1].map(|at| self.first_needed[at] as usize);
        &self.needed[from..to]
    }

    fn mark(&mut self, unit: u32) {
        if !self.is_stale[unit as usize] {
            self.is_stale[unit as usize] = true;
            self.stale.push(unit);
        }
    }
}

/// The value that is reckoned with.
pub(super) fn counted(value: f64) -> f64 {
    if value.is_nan() {
        0.0
    } else {
        value.clamp(-LARGEST_VALUE, LARGEST_VALUE)
    }
}
