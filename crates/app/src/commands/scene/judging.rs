//! How far is what an eye gets of a scene from the whole of it?
//!
//! A second player has every finest unit and draws the same view.

use crate::commands::scene::moving::Standing;
use crate::commands::score::{
    Companions, DeviceName, Engine, LastGaze, ScoreReport, display_named, display_of_view,
    from_image,
};
use crate::commands::simulate_score::ScoringOptions;
use crate::report::output;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Projection;
use foveal_eval::disc_error::{FOVEA_DEG, disc, error_over};
use foveal_eval::score::Viewing;
use foveal_media::pack::scene_file::SceneFile;
use foveal_play::{PlayError, ScenePlayer, ScenePlayerOptions, SceneReport};
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

/// Compares frame after frame; nothing where nothing draws.
pub(crate) struct Judge {
    whole: Option<ScenePlayer>,
    /// What the whole looks like, from the view that it was drawn for last.
    drawn: Option<(EyeView, RgbaImage)>,
    last: Option<(EyeView, foveal_core::gaze::sample::GazeSample, JudgedFrame)>,
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
    /// Judges the pictures of `view` that `drawing` makes of a scene.
    pub(crate) fn open(
        options: &ScoringOptions,
        file: &Arc<SceneFile>,
        view: &EyeView,
        drawing: &DrawDevice,
        fps: Option<f64>,
    ) -> anyhow::Result<Self> {
        options.check(drawing)?;
        let draws = !matches!(drawing, DrawDevice::Nothing);
        let all = ScenePlayerOptions {
            config: PolicyConfig::new(Policy::Full),
            drawing: drawing.clone(),
            bytes_per_s: f64::INFINITY,
            gpu_bytes: u64::MAX / 4,
            // What is damaged, the player that is judged has told.
            tell: |_| (),
        };
        let whole = match draws {
            true => Some(ScenePlayer::new(Arc::clone(file), all)?),
            false => None,
        };
        let scoring = options
            .is_asked()
            .then(|| Scoring::open(options, view, fps))
            .transpose()?;
        Ok(Self {
            whole,
            drawn: None,
            last: None,
            scoring,
        })
    }

    /// Compares what `player` shows of a view.
    pub(crate) fn frame(
        &mut self,
        player: &mut ScenePlayer,
        standing: &Standing,
        report: &SceneReport,
    ) -> anyhow::Result<Option<JudgedFrame>> {
        let Some(whole) = &mut self.whole else {
            return Ok(None);
        };
        let stays =
            |(view, gaze, _): &(EyeView, _, _)| *view == standing.view && *gaze == standing.gaze;
        let is_new = report.unit_bytes > 0 || self.last.as_ref().is_none_or(|last| !stays(last));
        if let (false, None, Some((.., judged))) = (is_new, &self.scoring, &self.last) {
            return Ok(Some(*judged));
        }
        if self
            .drawn
            .as_ref()
            .is_none_or(|(view, _)| *view != standing.view)
        {
            self.drawn = match whole_picture(whole, standing) {
                Err(error) if self.scoring.is_none() && is_too_much(&error) => {
                    output::say(&format!(
                        "errors are not told: the whole scene, which they are from, cannot be \
                         drawn: {error}"
                    ));
                    self.whole = None;
                    return Ok(None);
                }
                drawn => drawn?,
            };
        }
        let (Some((_, reference)), Some(test)) =
            (&self.drawn, player.picture_in_place(&standing.view)?)
        else {
            return Ok(None);
        };
        let fovea = disc(
            &standing.view,
            standing.gaze.gaze_in_content,
            Radians::from_degrees(FOVEA_DEG),
        );
        let pixels = test.pixels.len() / 4;
        let judged = JudgedFrame {
            fovea: (!fovea.is_empty())
                .then(|| error_over(fovea.into_iter(), &test.pixels, &reference.pixels)),
            all: error_over(0..pixels, &test.pixels, &reference.pixels),
        };
        if let Some(scoring) = &mut self.scoring {
            // A score is of what is seen.
            let seen = match player.drawer().is_morphing() {
                true => player.picture(&standing.view)?,
                false => None,
            };
            scoring.frame(reference, seen.as_ref().unwrap_or(&test), standing)?;
        }
        self.last = Some((standing.view, standing.gaze, judged));
        Ok(Some(judged))
    }

    /// The score of the run, by a `gaze` of that name.
    pub(crate) fn score(self, gaze: String) -> anyhow::Result<Option<ScoreReport>> {
        self.scoring.map(|scoring| scoring.report(gaze)).transpose()
    }
}

/// What the whole scene looks like from a view.
fn whole_picture(
    whole: &mut ScenePlayer,
    standing: &Standing,
) -> anyhow::Result<Option<(EyeView, RgbaImage)>> {
    whole.show(Seconds(0.0), &standing.moment)?;
    let picture = whole.picture(&standing.view)?;
    Ok(picture.map(|picture| (standing.view, picture)))
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
        reference: &RgbaImage,
        test: &RgbaImage,
        standing: &Standing,
    ) -> anyhow::Result<()> {
        let [reference, test] = [from_image(reference)?, from_image(test)?];
        let gaze_px = self.last_gaze.in_view(&standing.view, &standing.gaze);
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
