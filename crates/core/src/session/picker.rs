//! Which tiles are shown to a viewer who goes on looking, and how is that written down?
//!
//! One session follows the other whenever what it stands for changes: the view's size, the zoom,
//! the policy. A window and a page choose by the same picker.

use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::grid::level_map::LevelMap;
use crate::content::video::grid::tile_grid::{Tile, TileGrid};
use crate::content::video::losses::LossMeter;
use crate::content::video::units::Content;
use crate::perception::moment::Moment;
use crate::selection::chooser::Chooser;
use crate::session::aim::Aim;
use crate::session::log::{Given, Session, SessionFrame, SessionHead};
use crate::units::Radians;
use std::sync::OnceLock;

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
    /// Tells what is lost; made when first asked for.
    meter: OnceLock<LossMeter>,
    last: Option<Last>,
}

/// What was chosen last, for what.
#[derive(Clone, Debug)]
struct Last {
    frame: u32,
    moment: Moment,
    levels: LevelMap,
    /// The score that is expected of it; told when first asked for.
    jod: OnceLock<f64>,
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
            meter: OnceLock::new(),
            last: None,
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
        if config.perception != self.config.perception {
            self.meter = OnceLock::new();
        }
        self.config = config;
        self.running = None;
        self.last = None;
    }

    /// Whether what was chosen last reaches the target, so that more bytes would buy nothing.
    #[must_use]
    pub fn has_reached(&self) -> bool {
        let chooser = self.running.as_ref().map(|(chooser, _)| chooser);
        chooser.is_some_and(Chooser::has_reached)
    }

    /// The score that what was chosen last is expected to have against every finest tile, in JOD,
    /// once all of it is shown; `None` before any choice and for samples, which are not shown by
    /// tiles. `content` must know its signatures. Costs about 10 µs a cell in view where it was not
    /// asked for since the choice.
    #[must_use]
    pub fn expected_jod(&self, content: &dyn Content) -> Option<f64> {
        let last = self.last.as_ref()?;
        if self.config.policy == Policy::Sampled {
            return None;
        }
        let meter = || LossMeter::new(&self.grid, &self.config.perception);
        let jod = || {
            let meter = self.meter.get_or_init(meter);
            let losses = meter.losses(&self.grid, content, last.frame, &last.moment);
            self.config
                .policy
                .expectation()
                .jod(losses.pooled(&last.levels))
        };
        Some(*last.jod.get_or_init(jod))
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
        self.last = Some(Last {
            frame,
            moment,
            levels: selection.levels,
            jod: OnceLock::new(),
        });
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::asked::Detail;
    use crate::content::video::grid::tile_grid::Cut;
    use crate::gaze::sample::{GazeSample, HeadPose};
    use crate::pack::unit::UnitId;
    use crate::perception::measures::contrast::{BandContrast, Signature};
    use crate::perception::measures::cues::Cues;
    use crate::perception::parameters::EyeState;
    use crate::session::log_of_parts::SessionLog;
    use crate::units::Seconds;
    use crate::view::axes::Axes;
    use crate::view::eye_view::{EyeView, Field};
    use crate::view::surface::Surface;

    /// Textured everywhere alike.
    struct Even;

    impl Content for Even {
        fn unit(&self, tile: Tile, frame: u32) -> UnitId {
            let place = u32::from(tile.face) << 12 | u32::from(tile.y) << 6 | u32::from(tile.x);
            UnitId(place | u32::from(tile.level) << 16 | (frame / 8) << 20)
        }

        fn next_group(&self, _: u32) -> Option<u32> {
            None
        }

        fn bytes(&self, _: UnitId) -> u32 {
            1000
        }

        fn signature(&self, _: UnitId) -> Option<Signature> {
            let band = |before, after: f64| BandContrast {
                before,
                after,
                difference: after - before,
                norm: after - before,
            };
            Some(Signature {
                bands: [band(0.0, 0.1), band(0.08, 0.1), band(0.1, 0.1)],
            })
        }

        fn cues(&self, _: UnitId) -> Option<Cues> {
            None
        }
    }

    fn picker(config: PolicyConfig) -> Picker {
        let grid = TileGrid::new(Surface::cube(1024), Cut::Tile(128), 4, 2).unwrap();
        Picker::new("made", grid, config)
    }

    fn aim() -> Aim {
        let size = [1200, 800];
        Aim {
            gaze: GazeSample::at(Seconds(0.0), Radians(0.0), Radians(0.0)),
            view: EyeView {
                axes: Axes::FRONT,
                field: Field::across(Radians::from_degrees(90.0), size),
                size,
                eye: Default::default(),
            },
            head: HeadPose::default(),
            state: EyeState::Steady,
            behind_sound: None,
        }
    }

    fn expected(config: PolicyConfig) -> f64 {
        let mut picker = picker(config);
        assert_eq!(picker.expected_jod(&Even), None);
        let _ = picker.choose(Some(&Even), 0, &aim(), None);
        picker.expected_jod(&Even).unwrap()
    }

    #[test]
    fn what_is_chosen_for_a_score_is_expected_to_have_it() {
        for policy in [Policy::Acuity, Policy::Perceptual] {
            let targets = [8.5, 9.0, 9.5, 9.75];
            let jods = targets.map(|target| expected(Detail::Target(Some(target)).of(policy)));
            for (target, jod) in targets.into_iter().zip(jods) {
                assert!(jod >= target, "{policy:?} {target}: {jods:?}");
            }
            assert!(jods[0] < 9.75, "{policy:?}: {jods:?}");
        }
        assert!(expected(PolicyConfig::new(Policy::Coarsest)) < 8.5);
        assert_eq!(expected(PolicyConfig::new(Policy::Full)), 10.0);
    }

    #[test]
    fn buying_ends_where_the_score_is_reached_and_not_before() {
        let mut picker = picker(Detail::Target(Some(9.0)).of(Policy::Perceptual));
        let mut choose = |budget| {
            let picked = picker.choose(Some(&Even), 0, &aim(), Some(budget));
            let jod = picker.expected_jod(&Even).unwrap();
            (picked.spent, picker.has_reached(), jod)
        };
        let (spent, reached, jod) = choose(5_000);
        assert!(spent > 0 && !reached && jod < 9.0, "{jod}");
        let (_, reached, jod) = choose(1 << 30);
        assert!(reached && jod >= 9.0, "{jod}");
        assert_eq!(choose(1 << 30).0, 0);
    }

    #[test]
    fn what_stands_in_begins_a_session_of_its_own_and_the_log_replays() {
        let asked = Detail::Usual.of(Policy::Perceptual);
        let mut picker = picker(asked.without_signatures());
        let mut log = picker.choose(None, 0, &aim(), None).log;
        picker.change(asked);
        for frame in [0, 1, 9] {
            log += &picker.choose(Some(&Even), frame, &aim(), Some(60_000)).log;
        }
        let read = SessionLog::parse(&log).unwrap();
        assert_eq!(read.parts.len(), 2);
        assert_eq!(read.replay(Some(&Even)).write(), log);
    }
}
