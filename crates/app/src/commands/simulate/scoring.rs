//! How good is what the eye got, compared with the full picture?
//!
//! A second player shows every finest tile to the same eye; the judge knows where it truly looked,
//! whatever the system received.

use crate::commands::score::{
    Companions, DeviceName, Engine, LastGaze, ModeName, ScoreReport, display_named,
    display_of_view, picture_of,
};
use crate::report::output;
use crate::run::open_player::open_player;
use anyhow::{Context, bail};
use clap::Args;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Screen;
use foveal_eval::score::{Mode, Viewing};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::WatchedFrame;
use foveal_play::{Decoding, PlayerOptions};
use foveal_play::{FrameOptions, FramePlayer, FrameReport};
use foveal_render::DrawDevice;
use std::sync::Arc;

/// Whether and how a run is scored.
#[derive(Clone, Debug, Args)]
pub(crate) struct ScoringOptions {
    /// Score what the eye got against the full picture, by where it truly looked.
    #[arg(long)]
    score: bool,
    /// The display that shows the view, as `foveal score --display` (default: the view itself).
    #[arg(long, value_name = "NAME|FILE.toml", requires = "score")]
    score_display: Option<String>,
    /// As published, or right where that slips.
    #[arg(long, value_enum, default_value = "compat", requires = "score")]
    score_mode: ModeName,
}

/// What is played together with a run.
pub(crate) struct Baseline<'a> {
    pub(crate) file: &'a Arc<PackFile>,
    /// What shows the picture, while the head looks ahead: at least one view.
    pub(crate) views: Vec<EyeView>,
    pub(crate) screen: Screen,
    pub(crate) drawing: &'a DrawDevice,
    pub(crate) decoding: Decoding,
    /// Pictures a second; `None` where there is only one.
    pub(crate) fps: Option<f64>,
}

/// Scores frame after frame, each view by itself.
pub(crate) struct RunScoring {
    full: FramePlayer,
    mode: ModeName,
    judges: Vec<ViewJudge>,
}

/// Scores what one view shows.
struct ViewJudge {
    viewing: Viewing,
    engine: Engine,
    companions: Companions,
    last_gaze: LastGaze,
}

/// The scores of a run.
pub(crate) struct RunScores {
    /// The score of each view.
    pub(crate) jods: Vec<f64>,
    /// What is reported of the view that has the lowest.
    pub(crate) lowest: ScoreReport,
}

impl ScoringOptions {
    /// No score is asked for.
    pub(crate) fn unasked() -> Self {
        Self {
            score: false,
            score_display: None,
            score_mode: ModeName::Compat,
        }
    }

    /// What scores a run, if it is to be scored.
    pub(crate) fn open(&self, beside: &Baseline<'_>) -> anyhow::Result<Option<RunScoring>> {
        self.check(beside.drawing)?;
        if !self.score {
            return Ok(None);
        }
        let config = PolicyConfig::new(Policy::Full);
        let player = PlayerOptions::new(config, beside.drawing, output::say);
        let options = FrameOptions {
            screen: beside.screen,
            decoding: beside.decoding,
            ..FrameOptions::new(player, beside.views[0])
        };
        let full = open_player(beside.file, options)?;
        let fps = beside.fps;
        let judge = |view: &EyeView| {
            let display = match &self.score_display {
                Some(choice) => display_named("--score-display", choice)?,
                None => display_of_view(view, full.grid().surface.projection),
            };
            let viewing = Viewing::new(display, view.size, fps, true, self.score_mode.mode())?;
            anyhow::Ok(ViewJudge {
                engine: Engine::open(DeviceName::Cpu, &viewing, output::jobs(None)?)?,
                companions: Companions::beside(&viewing)?,
                last_gaze: LastGaze::new(view),
                viewing,
            })
        };
        let judges = beside.views.iter().map(judge);
        Ok(Some(RunScoring {
            judges: judges.collect::<anyhow::Result<_>>()?,
            full,
            mode: self.score_mode,
        }))
    }
}

impl ScoringOptions {
    /// Whether a score is asked for.
    pub(crate) fn is_asked(&self) -> bool {
        self.score
    }

    /// The display that was named, if any.
    pub(crate) fn display(&self) -> Option<&str> {
        self.score_display.as_deref()
    }

    /// As published, or right where that slips.
    pub(crate) fn mode(&self) -> Mode {
        self.score_mode.mode()
    }

    /// Refuses a score where nothing draws.
    pub(crate) fn check(&self, drawing: &DrawDevice) -> anyhow::Result<()> {
        if self.score && matches!(drawing, DrawDevice::Nothing) {
            bail!(output::WrongUsage(
                "--score compares pictures; give --renderer gpu or cpu".to_owned()
            ));
        }
        Ok(())
    }
}

impl RunScoring {
    /// Scores a frame that `player` shows, against the same frame whole.
    pub(crate) fn frame(
        &mut self,
        player: &mut FramePlayer,
        look: &WatchedFrame,
        report: &FrameReport,
    ) -> anyhow::Result<()> {
        self.full.show(report.session.frame, look)?;
        for (judge, view) in self.judges.iter_mut().zip(&report.views) {
            let reference = picture_of(&mut self.full, view)?;
            let test = picture_of(player, view)?;
            let gaze_px = judge.last_gaze.in_view(view, &report.gaze);
            judge.companions.frame(&reference, &test, gaze_px)?;
            judge.engine.frame(&reference, &test, gaze_px)?;
        }
        Ok(())
    }

    /// The scores of the run, by a `gaze` of that name.
    pub(crate) fn report(&self, gaze: &str) -> anyhow::Result<RunScores> {
        let of_view = |judge: &ViewJudge| {
            judge.last_gaze.tell_unseen();
            let (score, gaze) = (judge.engine.score()?, Some(gaze.to_owned()));
            let report = ScoreReport::judged(&judge.viewing, self.mode.mode(), gaze, score);
            Ok(report.with(judge.companions.totals(), judge.engine.name(), None))
        };
        let reports: anyhow::Result<Vec<ScoreReport>> = self.judges.iter().map(of_view).collect();
        RunScores::of(reports?)
    }
}

impl RunScores {
    /// The scores of views, each reported by itself.
    pub(crate) fn of(reports: Vec<ScoreReport>) -> anyhow::Result<Self> {
        let jods = reports.iter().map(|report| report.jod).collect();
        let lowest = reports.into_iter().min_by(|a, b| a.jod.total_cmp(&b.jod));
        Ok(Self {
            jods,
            lowest: lowest.context("nothing was scored")?,
        })
    }
}
