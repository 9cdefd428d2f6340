//! Which tiles does a page want, and what does it remember of why?

use crate::shelf::Shelf;
use foveal_core::asset::tile_grid::Tile;
use foveal_core::selection::aim::Aim;
use foveal_core::selection::budget::Budget;
use foveal_core::selection::content::Content;
use foveal_core::selection::picker::Picker;
use foveal_core::selection::policy::{Policy, PolicyConfig};
use foveal_core::selection::stage::Chooses;
use foveal_core::units::Seconds;
use foveal_render::RenderError;
use std::cell::RefCell;
use std::rc::Rc;

/// A log grows no longer than this, in bytes.
const MOST_LOG: usize = 64 << 20;
/// What a host is thought to bring before anything came from it, in bytes per second.
const FIRST_GUESS: f64 = 1e6;

/// Chooses under one policy at a time.
pub(crate) struct WebChoice {
    shelf: Rc<RefCell<Shelf>>,
    picker: Picker,
    log: Option<String>,
    bytes_per_s: f64,
    budget: Budget,
    /// When the budget was last asked.
    asked: Option<f64>,
    /// A choice was put off until what it needs is there.
    waits: Option<u32>,
}

impl WebChoice {
    pub(crate) fn new(shelf: Rc<RefCell<Shelf>>, picker: Picker, logs: bool) -> Self {
        Self {
            shelf,
            picker,
            log: logs.then(String::new),
            bytes_per_s: FIRST_GUESS,
            budget: Budget::new(FIRST_GUESS),
            asked: None,
            waits: None,
        }
    }

    pub(crate) fn config(&self) -> &PolicyConfig {
        self.picker.config()
    }

    pub(crate) fn policy(&self) -> Policy {
        self.config().policy
    }

    /// Chooses by another policy from now on; `false` where the pack lacks what it needs.
    pub(crate) fn change(&mut self, policy: Policy) -> bool {
        let can = self.picker.can(policy, self.shelf.borrow().has());
        if can {
            self.picker.change(PolicyConfig::new(policy));
            self.waits = None;
        }
        can
    }

    /// What the host brings, measured.
    pub(crate) fn set_rate(&mut self, bytes_per_s: f64) {
        let other = (bytes_per_s / self.bytes_per_s - 1.0).abs() > 0.05;
        if bytes_per_s.is_finite() && bytes_per_s > 0.0 && other {
            self.bytes_per_s = bytes_per_s;
            self.budget = Budget::new(bytes_per_s);
        }
    }

    pub(crate) fn log(&self) -> &str {
        self.log.as_deref().unwrap_or_default()
    }

    fn write(&mut self, lines: &str) {
        if let Some(log) = &mut self.log
            && log.len() + lines.len() <= MOST_LOG
        {
            log.push_str(lines);
        }
    }

    /// Whether a choice waits for what it needs.
    pub(crate) fn waits(&self) -> bool {
        self.waits.is_some()
    }

    /// Whether what a choice waited for is there, or may still be bought.
    fn may_go_on(&self) -> bool {
        let spends = self.policy().spends_a_budget();
        let ready = |frame| self.shelf.borrow().can_spend(frame);
        self.waits.is_some_and(ready) || spends && !self.budget.is_done()
    }
}

impl Chooses for WebChoice {
    type Error = RenderError;

    fn choose(&mut self, frame: u32, aim: &Aim) -> Result<Vec<Tile>, RenderError> {
        let shelf = Rc::clone(&self.shelf);
        let shelf = shelf.borrow();
        let spends = self.policy().spends_a_budget();
        self.waits = (spends && !shelf.can_spend(frame)).then_some(frame);
        if self.waits.is_some() {
            return Ok(shelf.grid.tiles_of(shelf.grid.coarsest()).collect());
        }
        let now = aim.gaze.time.0;
        let budget = spends.then(|| {
            let passed = now - self.asked.replace(now).unwrap_or(now);
            self.budget.after(Seconds(passed))
        });
        let content = spends.then_some(&*shelf as &dyn Content);
        let picked = self.picker.choose(content, frame, aim, budget);
        self.budget.spend(picked.spent);
        self.write(&picked.log);
        Ok(picked.tiles)
    }

    fn differs(&self, now: &Aim, before: &Aim) -> bool {
        self.may_go_on() || now.differs(before, self.policy())
    }
}
