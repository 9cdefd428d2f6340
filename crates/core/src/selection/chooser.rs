//! Who chooses the levels of a frame: a rule, or what a budget buys?

use super::content::Content;
use super::policy::{Moment, PolicyConfig, Selection};
use super::refine::Refiner;
use super::steady::SteadySelector;
use crate::asset::tile_grid::TileGrid;

/// Chooses frame after frame under one policy, whichever it is.
#[derive(Clone, Debug)]
pub enum Chooser {
    /// A rule: a frame depends on its moment, and on what was shown as far as it keeps levels
    /// steady.
    Rule(Box<SteadySelector>),
    /// Step by step, within what can arrive: a frame also depends on what came before.
    Budget(Box<Refiner>),
}

impl Chooser {
    /// The chooser of a policy.
    #[must_use]
    pub fn new(grid: TileGrid, config: PolicyConfig) -> Self {
        if config.policy.spends_a_budget() {
            Self::Budget(Box::new(Refiner::new(grid, config)))
        } else {
            Self::Rule(Box::new(SteadySelector::new(grid, config)))
        }
    }

    /// What to show of a frame. `budget` is what can arrive for it, in bytes; `None` without limit.
    ///
    /// # Panics
    /// A policy that spends a budget needs the content, whose bytes it spends on, and one with a
    /// noise threshold its cues.
    #[must_use]
    pub fn choose(
        &mut self,
        content: Option<&dyn Content>,
        frame: u32,
        moment: &Moment,
        budget: Option<u64>,
    ) -> Selection {
        match (self, content) {
            (Self::Rule(selector), content) => selector.select(content, frame, moment),
            (Self::Budget(refiner), Some(content)) => {
                refiner.refine(content, frame, moment, budget)
            }
            (Self::Budget(_), None) => panic!("a policy that spends a budget was given no content"),
        }
    }
}
