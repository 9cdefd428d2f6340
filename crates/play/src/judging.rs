//! How much of what the eye could see was shown?
//!
//! Observers look at what a player shows; no choice depends on them.

use crate::player::Player;
use crate::report::ExpectedLoss;
use foveal_core::content::policy::Policy;
use foveal_core::content::scene::worth::detail_share;
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::Video;
use foveal_core::content::video::grid::level_map::LevelMap;
use foveal_core::content::video::grid::tile_grid::TileGrid;
use foveal_core::content::video::losses::LossMeter;
use foveal_core::content::video::units::VideoUnits;
use foveal_core::content::video::worth::{Gains, Worth};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::glance::Glance;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::perception::visible_loss::quality_of_jod;
use foveal_core::session::unit_states::Piece;
use foveal_core::view::eye_view::EyeView;

/// Judges the tiles of a video by its signatures.
pub(crate) struct TileJudge {
    worth: Worth,
    meter: LossMeter,
    /// Whose targets the judge's losses are expected to reach.
    rule: Policy,
}

impl TileJudge {
    /// Judges tiles of `grid` that are chosen by `policy`.
    pub(crate) fn new(grid: &TileGrid, policy: Policy) -> Self {
        Self {
            worth: Worth::judge(grid),
            meter: LossMeter::new(grid, &Parameters::default()),
            rule: policy,
        }
    }

    /// Share of the visible detail that is shown of a frame, and the quality difference that is
    /// expected of it, in the view where that is largest; `None` without signatures.
    pub(crate) fn judged(
        &self,
        video: &Video,
        (frame, gaze, views): (u32, &GazeSample, &[EyeView]),
        shown: &LevelMap,
    ) -> Option<(f64, ExpectedLoss)> {
        if !video.has_signatures() {
            return None;
        }
        let grid = video.grid();
        let glances = views.iter().map(|view| Glance {
            gaze: *gaze,
            view: Some(*view),
            state: EyeState::Steady,
        });
        let through = |glance: Glance| {
            let losses = self.meter.lost(grid, (video, frame), &glance, shown);
            let gains = self.worth.gains(grid, video, frame, &glance);
            let scale = video.scale(glance.view.as_ref());
            let expected = scale.expected(self.rule.expectation(), &losses);
            let loss = ExpectedLoss {
                losses,
                quality: quality_of_jod(expected.jod),
                is_known: expected.is_known,
            };
            (gains, loss)
        };
        let (gains, losses): (Vec<Gains>, Vec<ExpectedLoss>) = glances.map(through).unzip();
        let gained = Gains::highest(gains).share(grid, shown);
        let most = losses
            .into_iter()
            .max_by(|a, b| a.quality.total_cmp(&b.quality));
        most.map(|most| (gained, most))
    }
}

impl Player {
    /// Share of the detail of a scene that a viewer could see who looks so, hidden or not, that is
    /// on screen; `None` of a video.
    #[must_use]
    pub fn detail_share(&self, moment: &Moment) -> Option<f64> {
        let scene = self.opened().scene()?;
        let states = self.session().states();
        let is_shown = |unit| {
            let asset = AssetId::ONLY;
            states.is_shown(Piece {
                unit: UnitRef { asset, unit },
                frame: 0,
            })
        };
        Some(detail_share(scene, moment, is_shown))
    }
}
