//! How good is what the eye got, beside the full picture?
//!
//! A second player shows every finest tile to the same eye; the judge knows where it truly looked,
//! whatever the system was told.

use crate::commands::score::{
    Companions, DeviceName, Engine, LastGaze, ModeName, ScoreReport, display_named,
    display_of_view, picture_of,
};
use crate::report::output;
use crate::run::open_player::open_player;
use anyhow::bail;
use clap::Args;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Screen;
use foveal_eval::score::{Mode, Viewing};
use foveal_media::pack::pack_file::PackFile;
use foveal_play::Decoding;
use foveal_play::Look;
use foveal_play::{FrameReport, Player, PlayerOptions};
use foveal_render::{DrawDevice, TileStyle};
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

/// What is played beside a run.
pub(crate) struct Baseline<'a> {
    pub(crate) file: &'a Arc<PackFile>,
    pub(crate) view: EyeView,
    pub(crate) screen: Screen,
    pub(crate) drawing: &'a DrawDevice,
    pub(crate) decoding: Decoding,
    /// Frames that will be played.
    pub(crate) frames: usize,
}

/// Scores frame after frame.
pub(crate) struct RunScoring {
    full: Player,
    viewing: Viewing,
    mode: ModeName,
    engine: Engine,
    companions: Companions,
    last_gaze: LastGaze,
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
        let options = PlayerOptions {
            config: PolicyConfig::new(Policy::Full),
            view: beside.view,
            screen: beside.screen,
            drawing: beside.drawing.clone(),
            style: TileStyle::default(),
            bytes_per_s: f64::INFINITY,
            paced: false,
            judged: false,
            tell: output::say,
            decoding: beside.decoding,
        };
        let full = open_player(Arc::clone(beside.file), options)?;
        let display = match &self.score_display {
            Some(choice) => display_named("--score-display", choice)?,
            None => display_of_view(&beside.view, full.grid().surface.projection),
        };
        let fps = (beside.frames > 1).then(|| beside.file.pack().description().fps());
        let mode = self.score_mode.mode();
        let viewing = Viewing::new(display, beside.view.size, fps, true, mode)?;
        Ok(Some(RunScoring {
            full,
            mode: self.score_mode,
            engine: Engine::open(DeviceName::Cpu, &viewing, output::jobs(None)?)?,
            companions: Companions::beside(&viewing)?,
            last_gaze: LastGaze::new(&beside.view),
            viewing,
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
        player: &mut Player,
        look: &Look,
        report: &FrameReport,
    ) -> anyhow::Result<()> {
        self.full.show(report.session.frame, look)?;
        let reference = picture_of(&mut self.full, &report.view)?;
        let test = picture_of(player, &report.view)?;
        let gaze_px = self.last_gaze.at(report);
        self.companions.frame(&reference, &test, gaze_px)?;
        self.engine.frame(&reference, &test, gaze_px)
    }

    /// The score of the run, by a `gaze` of that name.
    pub(crate) fn report(&self, gaze: String) -> anyhow::Result<ScoreReport> {
        self.last_gaze.tell_unseen();
        let score = self.engine.score()?;
        let report = ScoreReport::judged(&self.viewing, self.mode.mode(), Some(gaze), score);
        Ok(report.with(self.companions.totals(), self.engine.name(), None))
    }
}
