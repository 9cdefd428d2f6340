//! Which tiles does the policy choose, and how is that written down?

use super::timeline::Timeline;
use anyhow::{Context, bail};
use foveal_core::asset::cues::CueTable;
use foveal_core::asset::signature::Signatures;
use foveal_core::asset::tile_grid::{Tile, TileGrid};
use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::perception::parameters::{EyeState, Parameters};
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
}

struct Log {
    path: PathBuf,
    out: File,
}

impl Log {
    /// Writes whole lines at once: what was written when the program is killed can be replayed.
    fn write(&mut self, text: &str) -> anyhow::Result<()> {
        let written = self.out.write_all(text.as_bytes());
        written.with_context(|| format!("--log {}: cannot be written", self.path.display()))
    }
}

impl Choice {
    /// Chooses tiles of `grid`, and writes down what for and how where `log` says so.
    pub(crate) fn new(
        file: Arc<PackFile>,
        grid: TileGrid,
        config: PolicyConfig,
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
        };
        if !choice.can(choice.config.policy) {
            bail!(
                "{}: has no signatures, by which this policy values units; prepare it again",
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

    /// Whether the pack has what a policy chooses by.
    pub(crate) fn can(&self, policy: Policy) -> bool {
        !policy.spends_a_budget() || self.tables.0.is_some()
    }

    /// Chooses by another policy from now on.
    pub(crate) fn change(&mut self, config: PolicyConfig) {
        self.config = config;
        self.running = None;
    }

    /// Whether the choice for `now` could be another than for `before`.
    pub(crate) fn differs(&self, now: &Aim, before: &Aim) -> bool {
        let moved = angle_between(now.gaze.gaze_in_content, before.gaze.gaze_in_content);
        let gaze_counts = !matches!(
            self.config.policy,
            Policy::Full | Policy::Coarsest | Policy::Viewport | Policy::Uniform
        );
        now.view != before.view || gaze_counts && moved.to_degrees() > STILL_DEG
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
        let selection = chooser.choose(content, frame, &moment, None);
        if let Some(log) = &mut self.log {
            let given = Given {
                gaze: aim.gaze,
                head: aim.head,
                state: aim.state,
                budget: None,
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
