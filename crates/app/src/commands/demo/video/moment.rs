//! Which moment of a run do the pictures show?

use foveal_core::view::axes::angle_between;
use foveal_core::view::eye_view::EyeView;
use foveal_play::FrameReport;

/// From this turn of the gaze on, from one frame to the next, the eye is in a saccade; degrees.
const SACCADE_DEG: f64 = 1.0;
/// How much of the view round the gaze must be in one picture; degrees.
const AROUND_DEG: f64 = 4.0;
/// Where in the run the moment should be: late enough that the caches are warm.
const SHARE_OF_RUN: f64 = 0.6;

/// A frame a little after a saccade, and when the eye moved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PicturedMoment {
    /// Frame of the content.
    pub(crate) frame: u32,
    /// Whether the eye landed there a moment before.
    pub(crate) landed: bool,
    /// Whether the gaze turned since the frame before, of every frame.
    pub(crate) moving: Vec<bool>,
}

impl PicturedMoment {
    /// The moment of a run: the second frame of a fixation whose surroundings are all in view, the
    /// last frame where there is none.
    pub(crate) fn choose(reports: &[FrameReport]) -> Self {
        let moving: Vec<bool> = (0..reports.len())
            .map(|at| at > 0 && turned(&reports[at - 1], &reports[at]) > SACCADE_DEG)
            .collect();
        let landed = |at: &usize| *at >= 2 && !moving[*at] && !moving[*at - 1] && moving[*at - 2];
        let target = reports.len() as f64 * SHARE_OF_RUN;
        let chosen = (0..reports.len())
            .filter(landed)
            .filter(|at| is_in_view(&reports[*at]))
            .min_by(|a, b| {
                let away = |at: usize| (at as f64 - target).abs();
                away(*a).total_cmp(&away(*b))
            });
        let last = reports.len().saturating_sub(1);
        Self {
            frame: chosen.unwrap_or(last) as u32,
            landed: chosen.is_some(),
            moving,
        }
    }
}

fn turned(before: &FrameReport, after: &FrameReport) -> f64 {
    angle_between(before.gaze.gaze_in_content, after.gaze.gaze_in_content).to_degrees()
}

fn is_in_view(report: &FrameReport) -> bool {
    let gaze = report.gaze.gaze_in_content;
    let holds = |view: &EyeView| {
        let margin = view.ppd_towards(gaze).0 * AROUND_DEG;
        view.place(gaze).is_some_and(|place| {
            (0..2).all(|k| (margin..f64::from(view.size[k]) - margin).contains(&place[k]))
        })
    };
    report.views.iter().any(holds)
}
