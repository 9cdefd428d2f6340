//! What can be asked of a session?

use super::{Session, Staged};
use crate::content::demand::Content;
use crate::content::policy::PolicyConfig;
use crate::perception::moment::Moment;
use crate::session::figures::Figures;
use crate::session::log::SessionHead;
use crate::session::unit_states::{Piece, UnitStates};
use crate::units::Seconds;
use crate::view::timeline::Timeline;
use std::sync::Arc;

impl Session {
    /// Whether the scene has what a policy chooses by.
    #[must_use]
    pub fn can(&self, config: &PolicyConfig) -> bool {
        let meets = |asset: &Arc<dyn Content>| {
            let levels = usize::from(asset.coarsest());
            config.is_met_by(asset.has()) && config.thresholds.len() <= levels
        };
        self.scene.iter().all(meets)
    }

    /// The policy that is asked for.
    #[must_use]
    pub fn policy(&self) -> &PolicyConfig {
        self.run.asked()
    }

    /// The policy that chooses: what is asked for, or what stands in for it.
    #[must_use]
    pub fn policy_in_use(&self) -> &PolicyConfig {
        self.run.using()
    }

    /// Whether what was asked for waits for what it needs, and something else stands in.
    #[must_use]
    pub fn waits_for_tables(&self) -> bool {
        self.run.waits()
    }

    /// The score that what was chosen last is expected to have against every finest unit, in JOD,
    /// once all of it is shown; `None` before any choice and where it is unknown.
    #[must_use]
    pub fn expected_jod(&self) -> Option<f64> {
        self.run.expected_jod()
    }

    /// Whether what was bought last reaches the score that is asked for, so that more bytes would
    /// buy nothing; false where nothing is bought.
    #[must_use]
    pub fn has_reached(&self) -> bool {
        self.run.has_reached()
    }

    /// The head of the part of the log that a choice for `moment` belongs to.
    #[must_use]
    pub fn log_head(&self, moment: &Moment) -> SessionHead {
        self.run.head(moment)
    }

    /// Whether what is chosen depends on [`SessionEvent::Measured`].
    #[must_use]
    pub fn needs_footprints(&self) -> bool {
        self.run.needs_footprints()
    }

    /// What is counted.
    #[must_use]
    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    /// How far each unit has come.
    #[must_use]
    pub fn states(&self) -> &UnitStates {
        &self.states
    }

    /// How long the frame on screen is shown.
    #[must_use]
    pub fn period(&self) -> Seconds {
        let tick = self.shown_tick().unwrap_or(0);
        let [begin, end] = [tick, tick + 1].map(|tick| self.timeline.time_of(tick).0);
        Seconds(end - begin)
    }

    /// The frames in time.
    #[must_use]
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// Whether the viewer went elsewhere in time, and what is on screen is from before.
    #[must_use]
    pub fn has_jumped(&self) -> bool {
        self.jumped
    }

    /// The tick on screen.
    #[must_use]
    pub fn shown_tick(&self) -> Option<u64> {
        self.shown.as_ref().map(|shown| shown.tick)
    }

    /// The tick that is worked on, and all units that it is to show.
    #[must_use]
    pub fn wanted(&self) -> Option<(u64, &[Piece])> {
        let staged = self.coming.as_ref().or(self.shown.as_ref())?;
        Some((staged.tick, &staged.wanted))
    }

    /// What is to be fetched and decoded and did not come yet, first what matters most.
    #[must_use]
    pub fn requested(&self) -> &[Piece] {
        &self.requested
    }

    /// Whether what is on screen is what is due, with nothing missing.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        let complete = |shown: &Staged| shown.complete.is_some();
        let waits = self.run.needs_footprints() && self.is_measuring;
        !waits && self.coming.is_none() && self.shown.as_ref().is_some_and(complete)
    }

    /// Whether a choice is still to be made for where the viewer looks.
    #[must_use]
    pub fn is_behind(&self, moment: &Moment) -> bool {
        let shown = self.shown.as_ref();
        shown.is_none_or(|shown| self.differs(moment, shown))
    }

    /// When the frame that comes is due, by the content's time.
    #[must_use]
    pub fn next_due(&self) -> Option<Seconds> {
        let coming = self.coming.as_ref()?;
        Some(self.timeline.time_of(coming.tick))
    }

    /// Whether no frame at all has a whole coarsest level.
    #[must_use]
    pub fn is_hopeless(&self) -> bool {
        self.shown.is_none() && self.figures.damaged_frames >= self.timeline.frames()
    }
}
