//! How good is what the eye got, beside the full picture?
//!
//! A second player shows every finest tile to the same eye; the judge knows where it truly looked,
//! whatever the system was told.

use crate::canvas::{Drawing, Showing};
use crate::decoding::Decoding;
use crate::gaze::Look;
use crate::output;
use crate::player::{FrameReport, Player, PlayerOptions};
use crate::score::{
    Companions, DeviceName, Engine, ModeName, Report, display_named, display_of_view, from_image,
};
use anyhow::bail;
use clap::Args;
use foveal_core::selection::policy::{Policy, PolicyConfig};
use foveal_core::units::counted;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Screen;
use foveal_eval::score::{ScorePicture, Viewing};
use foveal_media::pack_file::PackFile;
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
    pub(crate) drawing: &'a Drawing,
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
    gaze_px: [f64; 2],
    /// Frames in which the eye looked at nothing that is shown.
    unseen: usize,
}

impl ScoringOptions {
    /// What scores a run, if it is to be scored.
    pub(crate) fn open(&self, beside: &Baseline<'_>) -> anyhow::Result<Option<RunScoring>> {
        if !self.score {
            return Ok(None);
        }
        if matches!(beside.drawing, Drawing::None) {
            bail!(output::WrongUsage(
                "--score compares pictures; give --renderer gpu or cpu".to_owned()
            ));
        }
        let options = PlayerOptions {
            config: PolicyConfig::new(Policy::Full),
            view: beside.view,
            screen: beside.screen,
            drawing: beside.drawing.clone(),
            showing: Showing::default(),
            bytes_per_s: f64::INFINITY,
            paced: false,
            judged: false,
            decoding: beside.decoding,
        };
        let full = Player::new(Arc::clone(beside.file), options)?;
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
            gaze_px: beside.view.size.map(|side| f64::from(side / 2)),
            unseen: 0,
            viewing,
        }))
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
        let reference = picture(&mut self.full, &report.view)?;
        let test = picture(player, &report.view)?;
        // A gaze beside the view or behind closed lids stays where it was last seen.
        let place = report.view.place(report.gaze.gaze_in_content);
        match place.filter(|_| report.gaze.valid) {
            Some(place) => self.gaze_px = place.map(|at| at - 0.5),
            None => self.unseen += 1,
        }
        self.companions.frame(&reference, &test, self.gaze_px)?;
        self.engine.frame(&reference, &test, self.gaze_px)
    }

    /// The score of the run, by a `gaze` of that name.
    pub(crate) fn report(&self, gaze: String) -> anyhow::Result<Report> {
        if self.unseen > 0 {
            output::say(&format!(
                "the gaze was not seen in {}, scored for the last gaze that was",
                counted(self.unseen, "frame")
            ));
        }
        let score = self.engine.score()?;
        let report = Report::judged(&self.viewing, self.mode.mode(), Some(gaze), score);
        Ok(report.with(self.companions.totals(), self.engine.name(), None))
    }
}

fn picture(player: &mut Player, view: &EyeView) -> anyhow::Result<ScorePicture> {
    match player.canvas.picture(view, None)? {
        Some(image) => from_image(&image),
        None => bail!("nothing draws the pictures to score; give --renderer gpu or cpu"),
    }
}
