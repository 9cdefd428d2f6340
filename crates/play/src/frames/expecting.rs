//! What is expected of what a player shows?

use super::FramePlayer;
use foveal_core::content::video::calibration::density_of;
use foveal_core::perception::parameters::Parameters;
use foveal_core::units::{Ppd, Seconds};

/// So many times as dense, or as coarse, a screen is another than the one that was judged.
const OTHER_SCREEN: f64 = 1.5;

impl FramePlayer {
    /// Whether the losses that are expected of frames predict a score: where a link limits what is
    /// bought only if a judge saw the content while it was prepared.
    #[must_use]
    pub fn knows_score(&self) -> bool {
        let spends = self.config().policy.spends_a_budget();
        self.video.calibration().is_some()
            || !(spends && self.options.player.bytes_per_s.is_finite())
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
        let buys = spends && self.options.player.bytes_per_s.is_finite();
        (buys && self.config().target.is_some()).then(|| self.player.session().has_reached())
    }

    /// Bytes that a link brings in this time; `None` without one.
    #[must_use]
    pub fn bytes_in(&self, time: Seconds) -> Option<f64> {
        let bytes = self.options.player.bytes_per_s * time.0;
        bytes.is_finite().then_some(bytes)
    }
}
