//! What would be fetched by raising everything in view evenly?

use super::catalog::{Catalog, Rung};
use super::closure::closure;
use super::plan::Choice;
use super::progress::Progress;
use super::rule::Misfit;
use std::collections::VecDeque;

impl Catalog {
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
}

/// The uniform baseline (UNI of Chen et al. 2022): of the visible units those at the coarsest level
/// are raised first, by one level, in the order of their numbers; what a step needs comes with it.
/// Values are reported, and decide nothing.
///
/// Costs one pass over the units a level.
#[derive(Clone, Debug)]
pub struct Uniform<'a, F> {
    progress: Progress<'a>,
    misfit: Misfit,
    is_visible: F,
    /// The round: units at this level are raised.
    level: u8,
    /// The next unit of this round.
    unit: u32,
    taken: VecDeque<Choice>,
}

impl<'a, F: Fn(u32) -> bool> Uniform<'a, F> {
    pub(super) fn new(catalog: &'a Catalog, budget: u64, misfit: Misfit, is_visible: F) -> Self {
        Self {
            progress: Progress::new(catalog, budget),
            misfit,
            is_visible,
            level: catalog.held.iter().copied().max().unwrap_or(0),
            unit: 0,
            taken: VecDeque::new(),
        }
    }

    /// The next unit to raise: at the level of this round and visible.
    fn next_unit(&mut self) -> Option<u32> {
        while self.level > 0 {
            let rest = self.unit..self.progress.catalog.units();
            for unit in rest {
                if self.progress.level(unit) == self.level && (self.is_visible)(unit) {
                    self.unit = unit + 1;
                    return Some(unit);
                }
            }
            self.unit = 0;
            self.level -= 1;
        }
        None
    }

    fn raise(&mut self, unit: u32) {
        let level = self.level - 1;
        let whole = closure(&self.progress, Rung { unit, level });
        if !whole.is_whole {
            return;
        }
        if whole.bytes() <= self.progress.left {
            whole.steps.iter().for_each(|step| self.progress.take(step));
            self.taken.extend(whole.steps);
        } else if self.misfit == Misfit::Stop {
            self.level = 0;
        }
    }
}

impl<F: Fn(u32) -> bool> Iterator for Uniform<'_, F> {
    type Item = Choice;

    fn next(&mut self) -> Option<Choice> {
        loop {
            if let Some(choice) = self.taken.pop_front() {
                return Some(choice);
            }
            let unit = self.next_unit()?;
            self.raise(unit);
        }
    }
}
