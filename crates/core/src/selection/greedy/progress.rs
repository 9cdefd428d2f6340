//! What has been chosen so far, and what is left to spend?

use super::catalog::{Catalog, Rung};
use super::plan::Choice;

/// A selection on its way.
#[derive(Clone, Debug)]
pub(super) struct Progress<'a> {
    pub(super) catalog: &'a Catalog,
    /// Level of each unit, with what has been chosen.
    pub(super) reached: Vec<u8>,
    /// Bytes left of the budget.
    pub(super) left: u64,
}

impl<'a> Progress<'a> {
    pub(super) fn new(catalog: &'a Catalog, budget: u64) -> Self {
        let reached = catalog.held.clone();
        Self {
            catalog,
            reached,
            left: budget,
        }
    }

    /// The level of a unit.
    pub(super) fn level(&self, unit: u32) -> u8 {
        self.reached[unit as usize]
    }

    /// Whether a stage is held or chosen.
    pub(super) fn has(&self, stage: Rung) -> bool {
        self.level(stage.unit) <= stage.level
    }

    /// Whether going to a stage needs more than the levels of its own unit.
    pub(super) fn is_blocked(&self, stage: Rung) -> bool {
        let Rung { unit, level } = stage;
        !self.catalog.needed.is_empty()
            && (level..self.level(unit)).any(|level| {
                let needed = self.catalog.prerequisites(Rung { unit, level });
                needed.iter().any(|needed| !self.has(*needed))
            })
    }

    /// Takes a step that fits.
    pub(super) fn take(&mut self, choice: &Choice) {
        self.left -= choice.bytes;
        self.reached[choice.unit as usize] = choice.level;
    }
}
