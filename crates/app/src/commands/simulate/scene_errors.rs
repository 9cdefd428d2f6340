//! How far is what an eye gets of a scene from the whole of it?
//!
//! A second player has every finest unit and draws the same views.

use crate::commands::score::{
    Companions, DeviceName, Engine, LastGaze, ScoreReport, display_named, display_of_view,
    from_image,
};
use crate::commands::simulate::moving::Standing;
use crate::commands::simulate::scoring::{RunScores, ScoringOptions};
use crate::report::output;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Projection;
use foveal_eval::disc_error::{FOVEA_DEG, disc, error_over};
use foveal_eval::score::Viewing;
use foveal_media::pack::scene_file::SceneFile;
use foveal_play::{Made, PlayError, Player, PlayerOptions};
use foveal_render::{DrawDevice, RenderError, RgbaImage};
use std::sync::Arc;

/// How far what came is from full detail, once it is in its place: root mean square of the
/// difference of linear luminance, over the mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JudgedFrame {
    /// In the disc round the gaze; `None` where no pixel lies in it.
    pub(crate) fovea: Option<f64>,
    /// Over the whole picture.
    pub(crate) all: f64,
}

/// Compares frame after frame, each view by itself; nothing where nothing draws.
pub(crate) struct Judge {
    whole: Option<Player>,
    views: Vec<JudgedView>,
}

/// What is known of one view.
#[derive(Default)]
struct JudgedView {
    /// What the whole looks like, from the view that it was drawn for last.
    drawn: Option<(EyeView, RgbaImage)>,
    last: Option<(EyeView, GazeSample, JudgedFrame)>,
    scoring: Option<Scoring>,
}

/// What scores a run.
struct Scoring {
    viewing: Viewing,
    engine: Engine,
    companions: Companions,
    last_gaze: LastGaze,
    mode: foveal_eval::score::Mode,
}

impl Judge {
    /// Judges the pictures of views that `drawing` makes of a scene.
    pub(crate) fn open(
        options: &ScoringOptions,
        file: &Arc<SceneFile>,
        views: &[EyeView],
        drawing: &DrawDevice,
        fps: Option<f64>,
    ) -> anyhow::Result<Self> {
        options.check(drawing)?;
        let draws = !matches!(drawing, DrawDevice::Nothing);
        // The player that is judged has reported what is damaged.
        let all = PlayerOptions::new(PolicyConfig::new(Policy::Full), drawing, |_| ());
        let whole = match draws {
            true => Some(Player::of_scene(file, all)?),
            false => None,
        };
        let judged = |view: &EyeView| {
            let scoring = options
                .is_asked()
                .then(|| Scoring::open(options, view, fps))
                .transpose()?;
            anyhow::Ok(JudgedView {
                scoring,
                ..JudgedView::default()
            })
        };
        let views = views.iter().map(judged).collect::<anyhow::Result<_>>()?;
        Ok(Self { whole, views })
    }

    /// Compares what `player` shows of every view; returns how far the first is off.
    pub(crate) fn frame(
        &mut self,
        player: &mut Player,
        standing: &Standing,
        report: &Made,
    ) -> anyhow::Result<Option<JudgedFrame>> {
        let mut first = None;
        for (at, view) in standing.moment.views.iter().enumerate() {
            let (Some(whole), Some(judged)) = (&mut self.whole, self.views.get_mut(at)) else {
                continue;
            };
            let found = match judged.frame((whole, player), (view, standing), report) {
                Err(error) if judged.scoring.is_none() && is_too_much(&error) => {
                    output::say(&format!(
                        "errors are not measured: the whole scene, which they are from, cannot be \
                         drawn: {error}"
                    ));
                    self.whole = None;
                    return Ok(None);
                }
                found => found?,
            };
            first = first.or(found);
        }
        Ok(first)
    }

    /// The scores of the run, by a `gaze` of that name; `None` where none were asked for.
    pub(crate) fn scores(self, gaze: &str) -> anyhow::Result<Option<RunScores>> {
        let scoring = self.views.into_iter().filter_map(|view| view.scoring);
        let reports = scoring.map(|scoring| scoring.report(gaze.to_owned()));
        let reports: Vec<ScoreReport> = reports.collect::<anyhow::Result<_>>()?;
        match reports.is_empty() {
            true => Ok(None),
            false => RunScores::of(reports).map(Some),
        }
    }
}

impl JudgedView {
    /// Compares a view of the whole scene with what a player shows of it.
    fn frame(
        &mut self,
        (whole, player): (&mut Player, &mut Player),
        (view, standing): (&EyeView, &Standing),
        report: &Made,
    ) -> anyhow::Result<Option<JudgedFrame>> {
        let stays = |(known, gaze, _): &(EyeView, _, _)| known == view && *gaze == standing.gaze;
        let is_new = report.new_bytes > 0 || self.last.as_ref().is_none_or(|last| !stays(last));
        if let (false, None, Some((.., judged))) = (is_new, &self.scoring, &self.last) {
            return Ok(Some(*judged));
        }
        if self.drawn.as_ref().is_none_or(|(known, _)| known != view) {
            self.drawn = whole_picture(whole, view, standing)?;
        }
        let (Some((_, reference)), Some(test)) = (&self.drawn, player.picture_in_place(view)?)
        else {
            return Ok(None);
        };
        let within = Radians::from_degrees(FOVEA_DEG);
        let fovea = disc(view, standing.gaze.gaze_in_content, within);
        let pixels = test.pixels.len() / 4;
        let judged = JudgedFrame {
            fovea: (!fovea.is_empty())
                .then(|| error_over(fovea.into_iter(), &test.pixels, &reference.pixels)),
            all: error_over(0..pixels, &test.pixels, &reference.pixels),
        };
        if let Some(scoring) = &mut self.scoring {
            // A score is of what is seen.
            let seen = match player.drawer().is_morphing() {
                true => player.picture(view, false)?,
                false => None,
            };
            let seen = seen.as_ref().unwrap_or(&test);
            scoring.frame((reference, seen), view, &standing.gaze)?;
        }
        self.last = Some((*view, standing.gaze, judged));
        Ok(Some(judged))
    }
}

/// What the whole scene looks like from a view.
fn whole_picture(
    whole: &mut Player,
    view: &EyeView,
    standing: &Standing,
) -> anyhow::Result<Option<(EyeView, RgbaImage)>> {
    whole.stand(Seconds(0.0), &standing.moment)?;
    let picture = whole.picture(view, false)?;
    Ok(picture.map(|picture| (*view, picture)))
}

/// Whether a device has no room for what was to be drawn.
fn is_too_much(error: &anyhow::Error) -> bool {
    let error = error.downcast_ref();
    matches!(error, Some(PlayError::Render(RenderError::TooMuch { .. })))
}

impl Scoring {
    fn open(options: &ScoringOptions, view: &EyeView, fps: Option<f64>) -> anyhow::Result<Self> {
        let display = match options.display() {
            Some(choice) => display_named("--score-display", choice)?,
            None => display_of_view(view, Projection::Cube),
        };
        let mode = options.mode();
        let viewing = Viewing::new(display, view.size, fps, true, mode)?;
        Ok(Self {
            engine: Engine::open(DeviceName::Cpu, &viewing, output::jobs(None)?)?,
            companions: Companions::beside(&viewing)?,
            last_gaze: LastGaze::new(view),
            viewing,
            mode,
        })
    }

    fn frame(
        &mut self,
        (reference, test): (&RgbaImage, &RgbaImage),
        view: &EyeView,
        gaze: &GazeSample,
    ) -> anyhow::Result<()> {
        let [reference, test] = [from_image(reference)?, from_image(test)?];
        let gaze_px = self.last_gaze.in_view(view, gaze);
        self.companions.frame(&reference, &test, gaze_px)?;
        self.engine.frame(&reference, &test, gaze_px)
    }

    fn report(&self, gaze: String) -> anyhow::Result<ScoreReport> {
        self.last_gaze.tell_unseen();
        let score = self.engine.score()?;
        let report = ScoreReport::judged(&self.viewing, self.mode, Some(gaze), score);
        Ok(report.with(self.companions.totals(), self.engine.name(), None))
    }
}
