//! What is expected of what a player shows?

use super::Player;
use crate::report::ExpectedLoss;
use foveal_core::content::video::calibration::density_of;
use foveal_core::content::video::grid::level_map::LevelMap;
use foveal_core::content::video::units::VideoUnits;
use foveal_core::content::video::worth::Gains;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::glance::Glance;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::perception::visible_loss::quality_of_jod;
use foveal_core::units::{Ppd, Seconds};
use foveal_core::view::eye_view::EyeView;

/// So many times as dense, or as coarse, a screen is another than the one that was judged.
const OTHER_SCREEN: f64 = 1.5;

impl Player {
    /// Whether the losses that are expected of frames predict a score: where a link limits what is
    /// bought only if a judge saw the content while it was prepared.
    #[must_use]
    pub fn knows_score(&self) -> bool {
        let spends = self.config().policy.spends_a_budget();
        self.video.calibration().is_some() || !(spends && self.options.bytes_per_s.is_finite())
    }

    /// The density of the view, where a target is kept by what was judged at others alone: flat
    /// content is judged on the usual screen.
    #[must_use]
    pub fn unjudged_density(&self) -> Option<Ppd> {
        self.config().target?;
        let view = &self.options.view;
        let (seen, density) = (
            view.as_seen().least_ppd(),
            density_of(&self.grid().surface, view),
        );
        let is_usual = (1.0 / OTHER_SCREEN..=OTHER_SCREEN).contains(&(seen.0 / density.0));
        let calibration = self.video.calibration()?;
        (!is_usual || !calibration.covers(density)).then_some(seen)
    }

    /// Whether a target is kept by what was judged for another eye than the one that is chosen for.
    #[must_use]
    pub fn is_of_another_eye(&self) -> bool {
        let config = self.config();
        let is_kept = config.target.is_some() && self.video.calibration().is_some();
        is_kept && config.perception != Parameters::default()
    }

    /// Whether a link buys no more because what was bought reaches the target; `None` where nothing
    /// is bought, or for no target.
    #[must_use]
    pub fn stopped_at_target(&self) -> Option<bool> {
        let spends = self.config().policy.spends_a_budget();
        let buys = spends && self.options.bytes_per_s.is_finite();
        (buys && self.config().target.is_some()).then(|| self.session.has_reached())
    }

    /// Bytes that a link brings in this time; `None` without one.
    #[must_use]
    pub fn bytes_in(&self, time: Seconds) -> Option<f64> {
        let bytes = self.options.bytes_per_s * time.0;
        bytes.is_finite().then_some(bytes)
    }

    /// Share of the visible detail that is shown, and the quality difference that is expected of
    /// it, in the view where that is largest.
    pub(super) fn judged(
        &self,
        frame: u32,
        gaze: &GazeSample,
        views: &[EyeView],
        shown: &LevelMap,
    ) -> Option<(f64, ExpectedLoss)> {
        let (judge, meter) = self.judge.as_ref()?;
        let (video, grid) = (&*self.video, self.grid());
        let rule = self.options.config.policy.expectation();
        if !video.has_signatures() {
            return None;
        }
        let glances = views.iter().map(|view| Glance {
            gaze: *gaze,
            view: Some(*view),
            state: EyeState::Steady,
        });
        let through = |glance: Glance| {
            let losses = meter.losses(grid, video, frame, &glance).of(shown);
            let gains = judge.gains(grid, video, frame, &glance);
            let scale = video.scale(glance.view.as_ref());
            let expected = scale.expected(rule, &losses);
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
