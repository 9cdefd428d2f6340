//! How good are the views of a run, by the judge?

use crate::commands::score::{
    DeviceName, Engine, LastGaze, ScoreReport, display_of_view, from_image,
};
use crate::gaze_source::GazeChoice;
use crate::report::output;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::Projection;
use foveal_eval::score::{Mode, ScorePicture, Viewing};
use foveal_play::{FramePlayer, FrameReport};

/// Pixels that are judged of a run: drawing them all would take a software driver minutes.
const JUDGED_PIXELS: f64 = 16e6;
/// Fewest and most frames of that.
const JUDGED_FRAMES: [f64; 2] = [2.0, 16.0];

/// How many frames of views are judged.
pub(crate) fn judged_frames(views: &[EyeView]) -> u32 {
    let pixels = views.iter().map(|view| view.size.map(f64::from));
    let pixels: f64 = pixels.map(|[w, h]| w * h).sum();
    let [least, most] = JUDGED_FRAMES;
    (JUDGED_PIXELS / pixels.max(1.0)).floor().clamp(least, most) as u32
}

/// Judges every view of a run by itself: frames of a film together, pictures of a still one by one.
pub(crate) struct Scorer {
    views: Vec<JudgedView>,
    is_still: bool,
    /// Of pictures that were judged one by one.
    done: Vec<ScoreReport>,
}

struct JudgedView {
    viewing: Viewing,
    engine: Engine,
    last_gaze: LastGaze,
}

impl Scorer {
    /// Of these views; `None` where no display shows one of them (a pixel a degree or fewer).
    pub(crate) fn open(
        views: &[EyeView],
        projection: Projection,
        fps: Option<f64>,
    ) -> anyhow::Result<Option<Self>> {
        let mut judged = Vec::new();
        for view in views {
            let display = display_of_view(view, projection);
            let Ok(viewing) = Viewing::new(display, view.size, fps, true, Mode::Compat) else {
                return Ok(None);
            };
            judged.push(JudgedView {
                engine: engine(&viewing)?,
                last_gaze: LastGaze::new(view),
                viewing,
            });
        }
        Ok(Some(Self {
            views: judged,
            is_still: fps.is_none(),
            done: Vec::new(),
        }))
    }

    /// Judges what the views of a frame show.
    pub(crate) fn frame(
        &mut self,
        reference: &[ScorePicture],
        test: &[ScorePicture],
        report: &FrameReport,
    ) -> anyhow::Result<()> {
        for (at, judged) in self.views.iter_mut().enumerate() {
            let gaze_px = judged.last_gaze.in_view(&report.views[at], &report.gaze);
            judged.engine.frame(&reference[at], &test[at], gaze_px)?;
            if self.is_still {
                self.done.push(judged.report()?);
                judged.engine = engine(&judged.viewing)?;
            }
        }
        Ok(())
    }

    /// The lowest score of all views and, of a still, of all pictures.
    pub(crate) fn lowest(self) -> anyhow::Result<Option<ScoreReport>> {
        let reports = match self.is_still {
            true => self.done,
            false => {
                let reports = self.views.iter().map(JudgedView::report);
                reports.collect::<anyhow::Result<_>>()?
            }
        };
        Ok(reports.into_iter().min_by(|a, b| a.jod.total_cmp(&b.jod)))
    }
}

impl JudgedView {
    fn report(&self) -> anyhow::Result<ScoreReport> {
        let gaze = Some(GazeChoice::Scan.as_judged());
        let score = self.engine.score()?;
        Ok(ScoreReport::judged(
            &self.viewing,
            Mode::Compat,
            gaze,
            score,
        ))
    }
}

fn engine(viewing: &Viewing) -> anyhow::Result<Engine> {
    Engine::open(DeviceName::Cpu, viewing, output::jobs(None)?)
}

/// What the views of a frame show; `None` where nothing draws.
pub(crate) fn pictures(
    player: &mut FramePlayer,
    views: &[EyeView],
) -> anyhow::Result<Option<Vec<ScorePicture>>> {
    let mut all = Vec::new();
    for view in views {
        let Some(image) = player.drawer().picture(view, None)? else {
            return Ok(None);
        };
        all.push(from_image(&image)?);
    }
    Ok(Some(all))
}
