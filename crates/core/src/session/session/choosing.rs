//! For which frame are units chosen, and when again?

use super::{Session, Staged};
use crate::perception::moment::Moment;
use crate::session::actions::{Now, Pace, SessionAction};
use crate::session::log::SessionFrame;
use crate::session::policy_run::Picked;
use crate::session::unit_states::Piece;
use crate::units::Seconds;
use std::collections::HashSet;

/// A picture is not chosen again more often than this while the view moves.
const CHOOSE_EVERY_S: f64 = 0.03;

impl Session {
    /// Orders units for the frame that comes, or for the one that stays.
    pub(super) fn order(&mut self, now: &Now) {
        if matches!(now.pace, Pace::FrameByFrame | Pace::FrameIsOver) {
            return;
        }
        let target = self.target(now);
        let stands = now.pace != Pace::Playing;
        if stands && self.shown_tick() == Some(target) {
            self.jumped = false;
            self.give_up_coming();
            if self.must_ask_anew {
                self.want_missing(now);
            }
            return self.refine(now);
        }
        // Damaged frames are given up one by one as they are due, not as fast as they fail.
        let due = self.timeline.tick_at(now.media);
        let is_given_up = |tick: u64| match stands {
            false => tick > due,
            true => tick == target,
        };
        if self.damaged.is_some_and(is_given_up) {
            self.give_up_coming();
            return;
        }
        // A frame under way is shown, however late, before another is begun; but not one that was
        // begun before it was known how long the one on screen is drawn.
        let period = self.period().0;
        let fits = |coming: &Staged| match stands {
            false if now.drawing.0 > coming.drawing + period => coming.tick >= target,
            false => coming.tick <= target + 1 || self.lead > 0.0,
            true => coming.tick == target,
        };
        if !self.coming.as_ref().is_some_and(fits) {
            self.give_up_coming();
            self.coming = Some(self.staged(target, now));
        }
        self.choose_coming(now);
    }

    /// The tick to work on: the one that is due, or playing the one after what is on screen.
    fn target(&self, now: &Now) -> u64 {
        let due = self.timeline.tick_at(now.media);
        if now.pace != Pace::Playing {
            return due;
        }
        let shown = self.shown_tick().filter(|_| !self.jumped);
        let after = |tick: Option<u64>| tick.map_or(0, |tick| tick + 1);
        // What follows the frame on screen is shown once that has been drawn.
        let lead = shown.map_or(self.lead, |_| self.lead.max(now.drawing.0));
        let ahead = self.timeline.tick_at(Seconds(now.media.0 + lead));
        due.max(ahead).max(after(shown)).max(after(self.damaged))
    }

    pub(super) fn staged(&self, tick: u64, now: &Now) -> Staged {
        Staged {
            tick,
            frame: self.timeline.frame_of(tick),
            frames: self.frames_of(tick),
            moment: None,
            chosen: f64::NEG_INFINITY,
            wanted: Vec::new(),
            shows: HashSet::new(),
            begun: now.wall.0,
            drawing: now.drawing.0,
            complete: None,
        }
    }

    /// Chooses the units of the frame that comes, once, and again while it takes long.
    fn choose_coming(&mut self, now: &Now) {
        let Some(coming) = &self.coming else {
            return;
        };
        let first = coming.wanted.is_empty();
        let old = now.wall.0 - coming.chosen > CHOOSE_EVERY_S;
        let stays = now.pace == Pace::Standing || now.wall.0 - coming.begun > 0.1;
        if first || old && stays && self.differs(&now.moment, coming) {
            let coming = self.coming.take();
            self.coming = coming.map(|coming| self.choose(coming, now));
            self.want_missing(now);
        } else if self.must_ask_anew {
            self.want_missing(now);
        }
    }

    /// Whether other units could be chosen for a frame than it has.
    pub(super) fn differs(&self, now: &Moment, staged: &Staged) -> bool {
        let before = staged.moment.as_ref();
        before.is_none_or(|before| self.run.differs(now, before))
    }

    /// Chooses the units of the frame that stays again when the viewer looks elsewhere.
    fn refine(&mut self, now: &Now) {
        let Some(shown) = &self.shown else {
            return;
        };
        let old = now.wall.0 - shown.chosen > CHOOSE_EVERY_S;
        if old && self.differs(&now.moment, shown) {
            let shown = self.shown.take().map(|shown| Staged {
                begun: now.wall.0,
                ..shown
            });
            let shown = shown.map(|shown| self.choose(shown, now));
            let wanted = shown.as_ref().map(|shown| shown.wanted.clone());
            self.shown = shown;
            self.show_again(wanted.unwrap_or_default());
            self.want_missing(now);
        }
    }

    /// Chooses what a frame shows.
    pub(super) fn choose(&mut self, staged: Staged, now: &Now) -> Staged {
        let Picked { units, log, line } = self.run.choose(&staged.frames, &now.moment, now.until);
        self.write(log, line);
        let wanted: Vec<Piece> = units.into_iter().map(|unit| staged.piece(unit)).collect();
        let wanted = self.fitting(wanted, now);
        self.memory.choose(wanted.iter().map(|piece| piece.unit));
        let before = staged.wanted;
        let staged = Staged {
            shows: wanted.iter().copied().collect(),
            wanted,
            moment: Some(now.moment.clone()),
            chosen: now.wall.0,
            complete: None,
            ..staged
        };
        let gone = before.iter().filter(|piece| !staged.shows.contains(piece));
        let gone: Vec<Piece> = gone.copied().collect();
        self.let_go(&gone);
        staged
    }

    fn write(&mut self, log: String, line: Option<SessionFrame>) {
        if !log.is_empty() {
            self.actions.push(SessionAction::Log(log));
        }
        self.actions
            .extend(line.map(|line| SessionAction::Chosen(Box::new(line))));
    }

    /// Chooses again at the next step, wherever the viewer looks.
    pub(super) fn forget_choice(&mut self) {
        if let Some(shown) = &mut self.shown {
            shown.chosen = f64::NEG_INFINITY;
            shown.moment = None;
        }
        self.give_up_coming();
    }

    pub(super) fn frames_of(&self, tick: u64) -> Vec<u32> {
        let frame = self.timeline.frame_of(tick);
        let frame_of = |moves: &bool| if *moves { frame } else { 0 };
        self.moves.iter().map(frame_of).collect()
    }
}
