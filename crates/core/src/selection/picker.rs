//! Which tiles are shown to a viewer who goes on looking, and how is that written down?
//!
//! One session follows the other whenever what it stands for changes: the view's size, the zoom,
//! the policy. A window and a page choose by the same picker.

use crate::asset::tile_grid::{Tile, TileGrid};
use crate::selection::aim::Aim;
use crate::selection::chooser::Chooser;
use crate::selection::content::Content;
use crate::selection::policy::{Moment, Policy, PolicyConfig};
use crate::selection::session::{Given, Session, SessionFrame, SessionHead};
use crate::units::Radians;

/// What is kept fine beside the view, at most in shares of its width: a window that is zoomed to a
/// corner of the content does not fetch the rest.
const MARGIN_SHARE: f64 = 0.25;

/// Chooses under one policy at a time.
#[derive(Clone, Debug)]
pub struct Picker {
    pack: String,
    grid: TileGrid,
    config: PolicyConfig,
    /// The chooser, and the head of the session that it chooses in.
    running: Option<(Chooser, SessionHead)>,
}

/// The side tables that a pack has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HasTables {
    /// What each unit adds.
    pub signatures: bool,
    /// What might draw the eye.
    pub cues: bool,
}

/// What was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Picked {
    /// The tiles to show, the whole coarsest level first.
    pub tiles: Vec<Tile>,
    /// Lines of a session log.
    pub log: String,
    /// Bytes that were spent of the budget.
    pub spent: u64,
}

impl Picker {
    /// Chooses tiles of `grid`; `pack` names what it is of in the log.
    #[must_use]
    pub fn new(pack: &str, grid: TileGrid, config: PolicyConfig) -> Self {
        Self {
            pack: pack.to_owned(),
            grid,
            config,
            running: None,
        }
    }

    /// The policy with its parameters.
    #[must_use]
    pub fn config(&self) -> &PolicyConfig {
        &self.config
    }

    /// Whether a pack with these tables has what a policy chooses by.
    #[must_use]
    pub fn can(&self, policy: Policy, has: HasTables) -> bool {
        let config = PolicyConfig {
            policy,
            ..self.config.clone()
        };
        (!policy.spends_a_budget() || has.signatures)
            && (!config.needs_cues() || has.signatures && has.cues)
            && config.thresholds.len() <= usize::from(self.grid.coarsest())
    }

    /// Chooses by another policy from now on.
    pub fn change(&mut self, config: PolicyConfig) {
        self.config = config;
        self.running = None;
    }

    /// What to show of a frame. `budget` is what can arrive for it, in bytes; `None` without limit.
    ///
    /// # Panics
    /// A policy that spends a budget needs the content, and one with a noise threshold its cues.
    pub fn choose(
        &mut self,
        content: Option<&dyn Content>,
        frame: u32,
        aim: &Aim,
        budget: Option<u64>,
    ) -> Picked {
        let head = self.head(aim);
        let mut log = String::new();
        let goes_on = |(_, running): &(Chooser, SessionHead)| *running == head;
        if !self.running.as_ref().is_some_and(goes_on) {
            let frames = Vec::new();
            let head = head.clone();
            log = Session { head, frames }.write();
            self.running = None;
        }
        let (chooser, _) = self.running.get_or_insert_with(|| {
            let chooser = Chooser::new(self.grid, head.policy.clone());
            (chooser, head)
        });
        let moment = Moment {
            gaze: aim.gaze,
            view: Some(aim.view),
            state: aim.state,
        };
        let selection = chooser.choose(content, frame, &moment, budget);
        let spent = chooser.spent();
        let given = Given {
            gaze: aim.gaze,
            head: aim.head,
            state: aim.state,
            budget,
        };
        let line = SessionFrame {
            behind_sound_s: aim.behind_sound,
            ..SessionFrame::new(frame, &given, &self.grid, &selection)
        };
        log.push_str(&line.write());
        let coarsest = self.grid.coarsest();
        let finer = selection.tiles.iter().filter(|tile| tile.level != coarsest);
        let tiles = self.grid.tiles_of(coarsest).chain(finer.copied()).collect();
        Picked { tiles, log, spent }
    }

    /// The head of the session that a choice for `aim` belongs to.
    fn head(&self, aim: &Aim) -> SessionHead {
        let field = aim.view.field;
        let across = (libm::atan(field.left) + libm::atan(field.right)).abs() * MARGIN_SHARE;
        let config = PolicyConfig {
            margin: Radians(self.config.margin.0.min(across)),
            ..self.config.clone()
        };
        SessionHead::new(&self.pack, &self.grid, config, &aim.view)
    }
}
