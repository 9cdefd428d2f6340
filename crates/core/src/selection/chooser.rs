//! Who chooses the levels of a frame: a rule, or what a budget buys?

use crate::content::policy::PolicyConfig;
use crate::content::video::grid::tile_grid::TileGrid;
use crate::content::video::rules::Selection;
use crate::content::video::rules::steady::SteadySelector;
use crate::content::video::rules::target::TargetSelector;
use crate::content::video::units::Content;
use crate::perception::moment::Moment;
use crate::selection::refine::Refiner;

/// Chooses frame after frame under one policy, whichever it is.
#[derive(Clone, Debug)]
pub enum Chooser {
    /// A rule: a frame depends on its moment, and on what was shown as far as it keeps levels
    /// steady.
    Rule(Box<SteadySelector>),
    /// Step by step, within what can arrive: a frame also depends on what came before.
    Budget(Box<Refiner>),
    /// For a score, where bytes are not limited; a budget is spent until the score is reached.
    Target(Box<TargetSelector>, Option<Box<Refiner>>),
}

impl Chooser {
    /// The chooser of a policy.
    #[must_use]
    pub fn new(grid: TileGrid, config: PolicyConfig) -> Self {
        let spends = config.policy.spends_a_budget();
        let refiner = || Box::new(Refiner::new(grid, config.clone()));
        match TargetSelector::new(&grid, &config) {
            Some(target) => Self::Target(Box::new(target), spends.then(refiner)),
            None if spends => Self::Budget(refiner()),
            None => Self::Rule(Box::new(SteadySelector::new(grid, config))),
        }
    }

    /// Bytes that the last frame took of the budget.
    #[must_use]
    pub fn spent(&self) -> u64 {
        match self {
            Self::Budget(refiner) | Self::Target(_, Some(refiner)) => refiner.spent(),
            Self::Rule(_) | Self::Target(_, None) => 0,
        }
    }

    /// Whether the last frame reaches the target, so that more bytes would buy nothing.
    #[must_use]
    pub fn has_reached(&self) -> bool {
        match self {
            Self::Budget(refiner) | Self::Target(_, Some(refiner)) => refiner.has_reached(),
            Self::Rule(_) | Self::Target(_, None) => false,
        }
    }

    /// What to show of a frame. `budget` is what can arrive for it, in bytes; `None` without limit.
    ///
    /// # Panics
    /// A policy that spends a budget, or has a target, needs the content, whose units it weighs;
    /// one with a noise threshold needs its cues.
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
            (Self::Target(_, Some(refiner)), Some(content)) if is_limited(budget) => {
                refiner.refine(content, frame, moment, budget)
            }
            (Self::Target(selector, _), Some(content)) => selector.select(content, frame, moment),
            (Self::Budget(refiner), Some(content)) => {
                refiner.refine(content, frame, moment, budget)
            }
            (Self::Budget(_) | Self::Target(..), None) => {
                panic!("a policy that weighs units was given no content")
            }
        }
    }
}

fn is_limited(budget: Option<u64>) -> bool {
    budget.is_some_and(|bytes| bytes < u64::MAX)
}
