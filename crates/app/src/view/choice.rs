//! Which tiles does the policy choose, and how is that written down?

use super::timeline::Timeline;
use crate::link::Link;
use crate::options::check_thresholds;
use anyhow::{Context, bail};
use foveal_core::asset::cues::CueTable;
use foveal_core::asset::signature::Signatures;
use foveal_core::asset::tile_grid::{Tile, TileGrid};
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::selection::budget::{Budget, MOST_SAVED_S};
use foveal_core::selection::chooser::Chooser;
use foveal_core::selection::content::{Content, PackContent};
use foveal_core::selection::policy::{Moment, Policy, PolicyConfig};
use foveal_core::selection::session::{Given, Session, SessionFrame, SessionHead};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use foveal_media::pack_file::PackFile;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A gaze that moved less has not moved, in degrees.
const STILL_DEG: f64 = 0.05;
/// What is kept fine beside the view, at most in shares of its width: a window that is zoomed to a
/// corner of the content does not fetch the rest.
const MARGIN_SHARE: f64 = 0.25;

/// What selection is given of the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    pub(crate) gaze: GazeSample,
    pub(crate) view: EyeView,
    pub(crate) head: HeadPose,
    pub(crate) state: EyeState,
    /// How far the picture is behind the sound, where there is sound.
    pub(crate) behind_sound: Option<Seconds>,
}

/// Chooses under one policy at a time, and logs it.
pub(crate) struct Choice {
    file: Arc<PackFile>,
    grid: TileGrid,
    config: PolicyConfig,
    tables: (Option<Signatures>, Option<CueTable>),
    /// The chooser, and the head of the session that it chooses in.
    running: Option<(Chooser, SessionHead)>,
    log: Option<Log>,
    link: Option<Spending>,
}

/// What a link brings, and what was bought of it.
struct Spending {
    budget: Budget,
    /// When it was last asked.
    until: f64,
    /// When it was last spent.
    bought: f64,
}

struct Log {
    path: PathBuf,
    out: File,
}

impl Spending {
    /// Bytes that can be spent at a time.
    fn ask(&mut self, now: Seconds) -> u64 {
        let passed = now.0 - std::mem::replace(&mut self.until, now.0);
        self.budget.after(Seconds(passed))
    }

    fn spend(&mut self, bytes: u64, now: Seconds) {
        self.budget.spend(bytes);
        if bytes > 0 {
            self.bought = now.0;
        }
    }
}

impl Log {
    /// Writes whole lines at once: what was written when the program is killed can be replayed.
    fn write(&mut self, text: &str) -> anyhow::Result<()> {
        let written = self.out.write_all(text.as_bytes());
        written.with_context(|| format!("--log {}: cannot be written", self.path.display()))
    }
}

impl Choice {
    /// Chooses tiles of `grid` within what a link brings, and writes down what for and how where
    /// `log` says so.
    pub(crate) fn new(
        file: Arc<PackFile>,
        grid: TileGrid,
        config: PolicyConfig,
        link: Option<Link>,
        log: Option<&Path>,
    ) -> anyhow::Result<Self> {
        let tables = (file.signatures()?, file.cues()?);
        let log = log.map(|path| {
            let out = File::create(path)
                .with_context(|| format!("--log {}: cannot be written", path.display()))?;
            anyhow::Ok(Log {
                path: path.to_owned(),
                out,
            })
        });
        let choice = Self {
            file,
            grid,
            config,
            tables,
            running: None,
            log: log.transpose()?,
            link: link.map(|link| Spending {
                budget: Budget::new(link.bytes_per_s),
                until: 0.0,
                bought: 0.0,
            }),
        };
        if !choice.can(choice.config.policy) {
            bail!(
                "{}: has no signatures or cues, by which this policy chooses; prepare it again",
                choice.file.path().display(),
            );
        }
        Ok(choice)
    }

    pub(crate) fn policy(&self) -> Policy {
        self.config.policy
    }

    pub(crate) fn perception(&self) -> &Parameters {
        &self.config.perception
    }

    /// The policy with its parameters.
    pub(crate) fn config(&self) -> &PolicyConfig {
        &self.config
    }

    /// Whether the pack has what a policy chooses by.
    pub(crate) fn can(&self, policy: Policy) -> bool {
        let config = PolicyConfig {
            policy,
            ..self.config.clone()
        };
        let cues = self.tables.0.is_some() && self.tables.1.is_some();
        (!policy.spends_a_budget() || self.tables.0.is_some())
            && (!config.needs_cues() || cues)
            && check_thresholds(&config, &self.grid).is_ok()
    }

    /// Chooses by another policy from now on.
    pub(crate) fn change(&mut self, config: PolicyConfig) {
        self.config = config;
        self.running = None;
    }

    /// Whether a link may still bring what was not chosen yet for lack of bytes.
    fn saves_up(&self, now: f64) -> bool {
        let link = self.link.as_ref();
        let link = link.filter(|_| self.config.policy.spends_a_budget());
        link.is_some_and(|link| now - link.bought < 2.0 * MOST_SAVED_S)
    }

    /// Whether the choice for `now` could be another than for `before`.
    pub(crate) fn differs(&self, now: &Aim, before: &Aim) -> bool {
        let moved = angle_between(now.gaze.gaze_in_content, before.gaze.gaze_in_content);
        let gaze_counts = !matches!(
            self.config.policy,
            Policy::Full | Policy::Coarsest | Policy::Viewport | Policy::Uniform
        );
        self.saves_up(now.gaze.time.0)
            || now.view != before.view
            || gaze_counts && moved.to_degrees() > STILL_DEG
    }

    /// The tiles to show of a frame, the whole coarsest level included.
    pub(crate) fn choose(
        &mut self,
        timeline: &Timeline,
        tick: u64,
        aim: &Aim,
    ) -> anyhow::Result<Vec<Tile>> {
        let head = self.head(aim);
        if self
            .running
            .as_ref()
            .is_none_or(|(_, running)| *running != head)
        {
            if let Some(log) = &mut self.log {
                let frames = Vec::new();
                log.write(
                    &Session {
                        head: head.clone(),
                        frames,
                    }
                    .write(),
                )?;
            }
            let chooser = Chooser::new(self.grid, head.policy.clone());
            self.running = Some((chooser, head));
        }
        let Some((chooser, _)) = &mut self.running else {
            return Ok(Vec::new());
        };
        let frame = timeline.frame_of(tick);
        let moment = Moment {
            gaze: aim.gaze,
            view: Some(aim.view),
            state: aim.state,
        };
        let content = self.tables.0.as_ref().map(|signatures| PackContent {
            pack: self.file.pack(),
            signatures,
            cues: self.tables.1.as_ref(),
        });
        let content = content.as_ref().map(|content| content as &dyn Content);
        let spends = self.config.policy.spends_a_budget();
        let mut link = self.link.as_mut().filter(|_| spends);
        let budget = link.as_mut().map(|link| link.ask(aim.gaze.time));
        let selection = chooser.choose(content, frame, &moment, budget);
        if let (Some(link), Chooser::Budget(refiner)) = (link, chooser) {
            link.spend(refiner.spent(), aim.gaze.time);
        }
        if let Some(log) = &mut self.log {
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
            log.write(&line.write())?;
        }
        let coarsest = self.grid.coarsest();
        let finer = selection.tiles.iter().filter(|tile| tile.level != coarsest);
        Ok(self.grid.tiles_of(coarsest).chain(finer.copied()).collect())
    }

    /// The head of the session that a choice for `aim` belongs to.
    fn head(&self, aim: &Aim) -> SessionHead {
        let name = self.file.path().file_name().unwrap_or_default();
        let field = aim.view.field;
        let across = (field.left.atan() + field.right.atan()).abs() * MARGIN_SHARE;
        let config = PolicyConfig {
            margin: Radians(self.config.margin.0.min(across)),
            ..self.config.clone()
        };
        SessionHead::new(&name.to_string_lossy(), &self.grid, config, &aim.view)
    }
}
