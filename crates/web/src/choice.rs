//! Which tiles does a page want, and what does it remember of why?

use crate::shelf::Shelf;
use foveal_core::content::asked::Detail;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::content::video::units::Content;
use foveal_core::session::aim::Aim;
use foveal_core::session::budget::Budget;
use foveal_core::session::picker::Picker;
use foveal_core::session::playback::Chooses;
use foveal_core::units::Seconds;
use foveal_render::RenderError;
use std::cell::RefCell;
use std::rc::Rc;

/// A log grows no longer than this, in bytes.
const MOST_LOG: usize = 64 << 20;
/// What a host is thought to bring before anything came from it, in bytes per second.
const FIRST_GUESS: f64 = 1e6;
/// How long what was chosen stays where the index of other frames is awaited, before something
/// else stands in and what was bought is forgotten, in seconds.
const PATIENCE_S: f64 = 0.5;

/// Chooses under one policy at a time.
pub(crate) struct WebChoice {
    shelf: Rc<RefCell<Shelf>>,
    /// Chooses by `config`, or by what stands in for it.
    picker: Picker,
    /// What is asked for.
    config: PolicyConfig,
    detail: Detail,
    log: Option<String>,
    bytes_per_s: f64,
    budget: Budget,
    /// When the budget was last asked.
    asked: Option<f64>,
    /// The frame for which something is not there yet that choosing needs.
    waits: Option<u32>,
    last: Option<Last>,
}

/// What was chosen last.
struct Last {
    /// When, by the clock of gazes.
    at: f64,
    tiles: Vec<Tile>,
}

impl WebChoice {
    pub(crate) fn new(shelf: Rc<RefCell<Shelf>>, name: &str, detail: Detail, logs: bool) -> Self {
        let config = detail.of(Policy::Coarsest);
        let picker = Picker::new(name, shelf.borrow().grid, config.clone());
        Self {
            shelf,
            picker,
            config,
            detail,
            log: logs.then(String::new),
            bytes_per_s: FIRST_GUESS,
            budget: Budget::new(FIRST_GUESS),
            asked: None,
            waits: None,
            last: None,
        }
    }

    /// What is asked for.
    pub(crate) fn config(&self) -> &PolicyConfig {
        &self.config
    }

    pub(crate) fn policy(&self) -> Policy {
        self.config.policy
    }

    /// Chooses by another policy from now on; `false` where the pack lacks what it needs.
    pub(crate) fn change(&mut self, policy: Policy) -> bool {
        let can = self.picker.can(policy, self.shelf.borrow().has());
        if can {
            self.config = self.detail.of(policy);
            self.waits = None;
        }
        can
    }

    /// Chooses at another detail from now on.
    pub(crate) fn set_detail(&mut self, detail: Detail) {
        self.detail = detail;
        self.config = detail.of(self.config.policy);
    }

    /// The score that what was chosen last is expected to have, as far as signatures tell.
    pub(crate) fn expected_jod(&self) -> Option<f64> {
        let shelf = self.shelf.borrow();
        let knows = shelf.has_signatures();
        knows.then(|| self.picker.expected_jod(&*shelf)).flatten()
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

    /// Whether what was asked for waits for what it needs, and something else stands in.
    pub(crate) fn waits(&self) -> bool {
        self.waits.is_some() && self.shelf.borrow().may_get_signatures()
    }

    /// Whether all is there by which what is asked for chooses for a frame.
    fn is_ready(&self, shelf: &Shelf, frame: u32) -> bool {
        match &self.config {
            config if config.policy.spends_a_budget() => shelf.can_spend(frame),
            config => !config.needs_signatures() || shelf.has_signatures(),
        }
    }

    /// Whether it is chosen by what is asked for, and not by what stands in.
    fn is_as_asked(&self) -> bool {
        *self.picker.config() == self.config
    }

    /// Whether what was chosen last stays while something is awaited.
    fn keeps(&self, now: f64) -> bool {
        let last = self.last.as_ref().filter(|_| self.is_as_asked());
        last.is_some_and(|last| (0.0..PATIENCE_S).contains(&(now - last.at)))
    }

    /// Whether what a choice waited for is there, or may still be bought.
    fn may_go_on(&self, now: f64) -> bool {
        let spends = self.picker.config().policy.spends_a_budget();
        let saves_up = spends && !self.budget.is_done() && !self.picker.has_reached();
        match self.waits {
            Some(frame) if self.waits() => {
                self.is_ready(&self.shelf.borrow(), frame)
                    || self.is_as_asked() && self.last.is_some() && !self.keeps(now)
            }
            _ => saves_up,
        }
    }

    /// Goes over to what is asked for, or to what stands in, whichever can choose now. Bytes of
    /// what was chosen so far for a frame, where that is new: they are here or under way, and cost
    /// nothing more.
    fn go_over(&mut self, shelf: &Shelf, frame: u32, is_ready: bool) -> u64 {
        let config = match is_ready {
            true => self.config.clone(),
            false => self.config.without_signatures(),
        };
        if *self.picker.config() == config {
            return 0;
        }
        self.picker.change(config);
        let tiles = self.last.iter().flat_map(|last| &last.tiles);
        let finer = tiles.filter(|tile| tile.level < shelf.grid.coarsest());
        let entries =
            finer.filter_map(|tile| shelf.pack.index().known_entry(shelf.unit(*tile, frame)));
        entries.map(|entry| u64::from(entry.bytes)).sum()
    }

    /// Bytes that can be spent now.
    fn saved(&mut self, now: f64) -> u64 {
        let passed = now - self.asked.replace(now).unwrap_or(now);
        self.budget.after(Seconds(passed))
    }
}

impl Chooses for WebChoice {
    type Error = RenderError;

    fn choose(&mut self, frame: u32, aim: &Aim) -> Result<Vec<Tile>, RenderError> {
        let shelf = Rc::clone(&self.shelf);
        let shelf = shelf.borrow();
        let now = aim.gaze.time.0;
        let is_ready = self.is_ready(&shelf, frame);
        self.waits = (!is_ready).then_some(frame);
        if !is_ready && self.keeps(now) {
            return Ok(self
                .last
                .iter()
                .flat_map(|last| last.tiles.clone())
                .collect());
        }
        let paid = self.go_over(&shelf, frame, is_ready);
        let spends = self.picker.config().policy.spends_a_budget();
        if spends && !is_ready {
            // Nothing stands in for what weighs bytes alone.
            self.last = None;
            return Ok(shelf.grid.tiles_of(shelf.grid.coarsest()).collect());
        }
        let budget = spends.then(|| self.saved(now).saturating_add(paid));
        let content = (self.picker.config().needs_signatures()).then_some(&*shelf as &dyn Content);
        let picked = self.picker.choose(content, frame, aim, budget);
        self.budget.spend(picked.spent);
        self.write(&picked.log);
        self.last = Some(Last {
            at: now,
            tiles: picked.tiles.clone(),
        });
        Ok(picked.tiles)
    }

    fn differs(&self, now: &Aim, before: &Aim) -> bool {
        self.may_go_on(now.gaze.time.0) || now.differs(before, self.policy())
    }
}
