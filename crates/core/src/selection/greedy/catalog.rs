//! What can be raised, and at what cost?

use super::choices::Choices;
use super::hull::Curve;
use super::plan::Plan;
use super::rule::{Misfit, Rule};
use super::uniform::Uniform;

/// Largest absolute value of a step: sums over any chain stay finite.
const LARGEST_VALUE: f64 = 1e300;

/// How the levels of a unit relate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chain {
    /// A level adds to the coarser ones: going several levels costs the bytes of all of them.
    Refining,
    /// A level replaces the coarser ones: going to it costs its own bytes, whatever is held.
    Replacing,
}

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
pub struct Stage {
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
    pub(super) needed: Vec<Stage>,
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
    /// over the next coarser one. Only units whose values changed are looked at anew.
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

    /// The steps to take with `budget` bytes, best value per byte first, worked out one by one: to
    /// cancel, stop asking.
    ///
    /// Equal densities go to fewer bytes, then to more value, then to the lower unit number. So
    /// numbering the units otherwise changes at most which of two equal steps comes first.
    pub fn choices(&mut self, budget: u64) -> Choices<'_> {
        self.refresh();
        Choices::new(self, budget)
    }

    /// All the steps to take with `budget` bytes.
    pub fn select(&mut self, budget: u64) -> Plan {
        self.choices(budget).collect()
    }

    /// The uniform baseline (UNI): the units that `is_visible` are raised evenly, one level at a
    /// time, whatever a step is worth.
    pub fn uniform<F: Fn(u32) -> bool>(
        &self,
        budget: u64,
        misfit: Misfit,
        is_visible: F,
    ) -> Uniform<'_, F> {
        Uniform::new(self, budget, misfit, is_visible)
    }

    /// Places of a unit's steps in the arrays of steps.
    pub(super) fn steps(&self, unit: u32) -> core::ops::Range<usize> {
        let at = unit as usize;
        self.first[at] as usize..self.first[at + 1] as usize
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

    /// What a step needs besides the coarser levels of its own unit.
    pub(super) fn prerequisites(&self, stage: Stage) -> &[Stage] {
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
