//! What does one viewer do with a session: play, go elsewhere in time, look around?
//!
//! The window and the page share it. Time, gaze and sound come in as arguments; what is left to
//! them is what they alone have: keys, a sound device, a screen, threads.

#[cfg(test)]
mod tests;

use crate::gaze::pointer::Pointer;
use crate::perception::moment::Moment;
use crate::session::actions::{Now, Pace, SessionEvent};
use crate::session::media_clock::MediaClock;
use crate::session::session::Session;
use crate::units::Seconds;
use crate::view::eye_view::EyeView;
use crate::view::navigation::{Navigation, Pane, Shown};

/// Radius of the disc round the gaze that is marked, in degrees: the fovea.
const FOVEA_DEG: f64 = 2.5;
/// How soon to step again for a frame that is overdue, in seconds.
const OVERDUE_S: f64 = 0.02;
/// How soon to step again while what stands is refined, in seconds.
const REFINED_S: f64 = 0.03;
/// How soon to step again while the view or the picture moves by itself, in seconds.
const UNDER_WAY_S: f64 = 1.0 / 60.0;

/// What happens when a round of the content is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtEnd {
    /// The next round begins.
    GoesRound,
    /// The last frame stays.
    Stays,
    /// The last frame stays, and playing then starts from the beginning.
    StaysUntilPlayed,
}

/// What a viewer begins with.
#[derive(Clone, Copy, Debug)]
pub struct ViewerSettings {
    /// Whether it plays once time begins.
    pub plays: bool,
    /// What happens at the end.
    pub at_end: AtEnd,
    /// Whether what was drawn too early is held back until its time: then a frame is chosen for as
    /// long a drawing as most stay below, and otherwise for a usual one.
    pub holds_early: bool,
}

/// What is heard of the content at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heard {
    /// No clock.
    Nothing,
    /// Sound is on its way that begins at this time of the content; it is heard after so many
    /// seconds, where that is known.
    Begins(Seconds, Option<Seconds>),
    /// This time of the content, counted on through all its rounds.
    At(Seconds),
    /// This time of a round of the content.
    InRound(Seconds),
}

/// The fovea where it is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoveaDisc {
    /// Where its middle is shown, in pixels of what is shown; far outside where that cannot be.
    pub place: [f64; 2],
    /// Its radius in those pixels.
    pub radius: f64,
}

/// One viewer before a session.
///
/// ```
/// use foveal_core::session::viewer::{AtEnd, Viewer, ViewerSettings};
/// use foveal_core::units::{Radians, Seconds};
/// use foveal_core::view::navigation::Navigation;
/// use foveal_core::view::surface::{Screen, Surface};
/// let surface = Surface::flat([1920, 1080], Screen::default());
/// let settings = ViewerSettings {
///     plays: true,
///     at_end: AtEnd::GoesRound,
///     holds_early: false,
/// };
/// let mut viewer = Viewer::new(Navigation::new(surface, Radians(1.0)), settings);
/// assert_eq!(viewer.time(Seconds(7.0)), Seconds(0.0));
/// viewer.begin(Seconds(7.0));
/// assert_eq!(viewer.time(Seconds(9.0)), Seconds(2.0));
/// ```
#[derive(Clone, Debug)]
pub struct Viewer {
    /// What of the content is shown.
    pub navigation: Navigation,
    /// The pointer over what is shown.
    pub pointer: Pointer,
    settings: ViewerSettings,
    clock: MediaClock,
    /// Whether it plays once time begins; `None` from then on.
    begins: Option<bool>,
    /// It stays at the end, and was not played since.
    ended: bool,
    /// While the frame waits for sound: in how many seconds that is heard, infinite where that
    /// is unknown.
    heard_in: Option<f64>,
    /// What the last step was made for.
    last: Option<(Moment, Shown)>,
    /// The tick that was drawn last.
    drawn_tick: Option<u64>,
    /// Whether what draws changes the picture by itself.
    is_morphing: bool,
}

impl Viewer {
    /// A viewer for whom time has not begun: [`Self::begin`] begins it.
    #[must_use]
    pub fn new(navigation: Navigation, settings: ViewerSettings) -> Self {
        Self {
            navigation,
            pointer: Pointer::default(),
            settings,
            clock: MediaClock::default(),
            begins: Some(settings.plays),
            ended: false,
            heard_in: None,
            last: None,
            drawn_tick: None,
            is_morphing: false,
        }
    }

    /// Time begins, where it plays: a page waits with that for what it shows first.
    pub fn begin(&mut self, now: Seconds) {
        if self.begins.take() == Some(true) {
            self.clock.play(now);
        }
    }

    /// Plays from where it is, or from the beginning once it ended and the settings say so.
    pub fn play(&mut self, session: &mut Session, now: Seconds) {
        if let Some(plays) = &mut self.begins {
            *plays = true;
            return;
        }
        let has_ended = std::mem::take(&mut self.ended);
        if has_ended && self.settings.at_end == AtEnd::StaysUntilPlayed {
            self.seek(session, Seconds(0.0), now);
        }
        self.clock.play(now);
    }

    /// Stays at the frame that is on screen.
    pub fn pause(&mut self, session: &Session, now: Seconds) {
        if let Some(plays) = &mut self.begins {
            *plays = false;
            return;
        }
        let timeline = session.timeline();
        let due = timeline.tick_at(self.clock.time(now));
        // What is on screen after a jump is where it came from.
        let shown = session.shown_tick().filter(|_| !session.has_jumped());
        let tick = shown.unwrap_or(due);
        self.clock.pause(timeline.time_of(tick));
    }

    /// Goes on from another time of the content.
    pub fn seek(&mut self, session: &mut Session, to: Seconds, now: Seconds) {
        self.ended = false;
        self.clock.seek(to, now);
        session.take(SessionEvent::Jumped);
    }

    /// Goes forward or back, not beyond the ends of the round that is under way.
    pub fn skip(&mut self, session: &mut Session, seconds: f64, now: Seconds) {
        let timeline = session.timeline();
        let at = self.clock.time(now);
        let begin = timeline.tick_at(at) / timeline.frames() * timeline.frames();
        let [first, last] = [begin, begin + timeline.frames() - 1].map(|t| timeline.time_of(t).0);
        let to = Seconds((at.0 + seconds).clamp(first, last));
        self.seek(session, to, now);
    }

    /// Goes to the first frame of the round that is under way.
    pub fn seek_first(&mut self, session: &mut Session, now: Seconds) {
        self.seek_in_round(session, 0, now);
    }

    /// Goes to the last frame of the round that is under way.
    pub fn seek_last(&mut self, session: &mut Session, now: Seconds) {
        let last = session.timeline().frames() - 1;
        self.seek_in_round(session, last, now);
    }

    fn seek_in_round(&mut self, session: &mut Session, frame: u64, now: Seconds) {
        let timeline = session.timeline();
        let tick = timeline.tick_at(self.clock.time(now));
        let to = timeline.time_of(tick - tick % timeline.frames() + frame);
        self.seek(session, to, now);
    }

    /// Pauses, and goes this many frames on or back; before the first comes the last.
    pub fn step_frames(&mut self, session: &mut Session, frames: i64, now: Seconds) {
        if self.is_playing() {
            self.pause(session, now);
        }
        let timeline = session.timeline();
        let tick = timeline.tick_at(self.clock.time(now));
        let around = if frames < 0 && tick < frames.unsigned_abs() {
            timeline.frames()
        } else {
            0
        };
        let tick = (tick + around).saturating_add_signed(frames);
        let to = timeline.time_of(match self.settings.at_end {
            AtEnd::GoesRound => tick,
            AtEnd::Stays | AtEnd::StaysUntilPlayed => tick.min(timeline.frames() - 1),
        });
        self.seek(session, to, now);
    }

    /// Keeps to what is heard: waits where sound begins, and follows it from then on.
    pub fn hear(&mut self, session: &Session, heard: Heard, now: Seconds) {
        let waited = self.heard_in.take().is_some();
        match heard {
            Heard::Nothing => {}
            Heard::Begins(at, within) => {
                self.clock.seek(at, now);
                self.heard_in = Some(within.map_or(f64::INFINITY, |within| within.0));
            }
            // What stands is in step with anything.
            _ if !self.is_moving(session) => {}
            Heard::At(at) if waited => self.clock.seek(at, now),
            Heard::At(at) => self.clock.follow(at, now),
            Heard::InRound(at) => {
                let nearest = self.nearest_round(session, at, now);
                self.clock.follow(nearest, now);
            }
        }
    }

    /// The time that is `within` some round and nearest to the one it is now.
    fn nearest_round(&self, session: &Session, within: Seconds, now: Seconds) -> Seconds {
        let timeline = session.timeline();
        let time = self.clock.time(now);
        let begin = time.0 - timeline.within(time).0;
        let length = timeline.length().0;
        let near = [begin - length, begin, begin + length].map(|round| round + within.0);
        let off = |at: &f64| (at - time.0).abs();
        let nearest = near.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        Seconds(nearest.unwrap_or(within.0))
    }

    /// Stays at the last frame once the content is over, where the settings say so; returns whether
    /// it just came to stay.
    pub fn stay_at_the_end(&mut self, session: &Session, now: Seconds) -> bool {
        let timeline = session.timeline();
        let over = self.clock.time(now).0 >= timeline.length().0;
        let stays = self.settings.at_end != AtEnd::GoesRound && over && self.clock.is_playing();
        if stays {
            self.clock.pause(timeline.time_of(timeline.frames() - 1));
            self.ended = true;
        }
        stays
    }

    /// Whether it plays, or is going to once time begins.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.begins.unwrap_or(self.clock.is_playing())
    }

    /// Whether the content moves.
    #[must_use]
    pub fn is_moving(&self, session: &Session) -> bool {
        self.clock.is_playing() && !session.timeline().is_still()
    }

    /// Time of the content, counted on through all its rounds.
    #[must_use]
    pub fn time(&self, now: Seconds) -> Seconds {
        self.clock.time(now)
    }

    /// What a session is to step at, for a viewer who looks like this.
    #[must_use]
    pub fn now(&self, session: &Session, moment: &Moment, now: Seconds) -> Now {
        Now {
            wall: now,
            media: self.due(session, now),
            pace: match self.is_moving(session) {
                true => Pace::Playing,
                false => Pace::Standing,
            },
            drawing: self.slow_draw(session),
            until: moment.gaze.time,
            moment: moment.clone(),
        }
    }

    /// A session stepped at [`Self::now`] for this moment. Returns whether something else is to be
    /// drawn because the view moved, or, where what is drawn is `drawn_by_gaze`, the gaze.
    pub fn stepped(&mut self, moment: Moment, pane: &Pane, drawn_by_gaze: bool) -> bool {
        let shown = self.shown(pane);
        let differs = |(before, shown_before): &(Moment, Shown)| {
            let moved = before.gaze.gaze_in_content != moment.gaze.gaze_in_content;
            *shown_before != shown || drawn_by_gaze && moved
        };
        let changed = self.last.as_ref().is_some_and(differs);
        self.last = Some((moment, shown));
        changed
    }

    /// Whether what draws still changes the picture by itself after the last step: until it does
    /// not, nothing is settled, and steps follow soon.
    pub fn set_morphing(&mut self, is_morphing: bool) {
        self.is_morphing = is_morphing;
    }

    /// What the last step was made for.
    #[must_use]
    pub fn moment(&self) -> Option<&Moment> {
        self.last.as_ref().map(|(moment, _)| moment)
    }

    /// What of the pane is covered, and what it shows.
    #[must_use]
    pub fn shown(&self, pane: &Pane) -> Shown {
        self.navigation.shown(pane)
    }

    /// Where the fovea is in what the last step was made for.
    #[must_use]
    pub fn fovea(&self) -> Option<FoveaDisc> {
        let (_, Shown { view, .. }) = self.last.as_ref()?;
        self.fovea_in(view)
    }

    /// Where it is in another view.
    #[must_use]
    pub fn fovea_in(&self, view: &EyeView) -> Option<FoveaDisc> {
        let (moment, _) = self.last.as_ref()?;
        let direction = moment.gaze.gaze_in_content;
        let seen = view.seen_direction(direction).unwrap_or(direction);
        Some(FoveaDisc {
            place: view.place(direction).unwrap_or([-1e6; 2]),
            radius: view.as_seen().ppd_towards(seen).0 * FOVEA_DEG,
        })
    }

    /// The moment of the content to show: the one that it is when it has been drawn.
    fn due(&self, session: &Session, now: Seconds) -> Seconds {
        let slow = self.slow_draw(session).0;
        let drawing = if self.settings.holds_early && slow > 0.0 {
            // Most are drawn by then, and wait.
            slow
        } else if self.is_moving(session) {
            session.figures().draw_s
        } else {
            0.0
        };
        let waits = self.heard_in.unwrap_or(0.0);
        Seconds(self.clock.time(now).0 + (drawing - waits).max(0.0))
    }

    /// How long drawing takes where some frames are left out because of it, and else 0.
    fn slow_draw(&self, session: &Session) -> Seconds {
        let moving = self.is_moving(session);
        let slow = moving.then(|| session.figures().slow_draw(session.period()));
        slow.unwrap_or_default()
    }

    /// Whether a frame that was not on screen before is held back until its time once it is drawn.
    #[must_use]
    pub fn holds_back(&self, session: &Session) -> bool {
        self.settings.holds_early && self.slow_draw(session).0 > 0.0 && !self.is_drawn(session)
    }

    /// How long it is at `now` until the time of what is to be shown: it was chosen for a drawing
    /// as long as the longest recent one, and is not earlier than that.
    #[must_use]
    pub fn early_by(&self, session: &Session, now: Seconds) -> Seconds {
        let begin = session.shown_tick();
        let begin = begin.map(|tick| session.timeline().time_of(tick));
        let early = begin.map_or(0.0, |begin| begin.0 - self.clock.time(now).0);
        let waits = self.heard_in.filter(|_| early > 0.0).unwrap_or(0.0);
        Seconds((early + waits).clamp(0.0, self.slow_draw(session).0))
    }

    /// Whether the frame to be shown was drawn before.
    #[must_use]
    pub fn is_drawn(&self, session: &Session) -> bool {
        self.drawn_tick == session.shown_tick()
    }

    /// The tick that was drawn last.
    #[must_use]
    pub fn drawn_tick(&self) -> Option<u64> {
        self.drawn_tick
    }

    /// What is to be shown was drawn; it took so long, where that says how long the next one takes.
    pub fn drawn(&mut self, session: &mut Session, took: Option<Seconds>) {
        self.drawn_tick = session.shown_tick();
        if let Some(took) = took.filter(|_| self.is_moving(session)) {
            session.take(SessionEvent::Drawn { took });
        }
    }

    /// Whether nothing on screen is going to change by itself, or it plays.
    #[must_use]
    pub fn is_settled(&self, session: &Session) -> bool {
        if self.is_moving(session) {
            return session.shown_tick().is_some();
        }
        session.is_settled()
            && !session.waits_for_tables()
            && !self.navigation.is_under_way()
            && !self.is_morphing
            && self
                .moment()
                .is_some_and(|moment| !session.is_behind(moment))
    }

    /// When to step again though nothing happens; `None` where nothing is going to change.
    #[must_use]
    pub fn next_step(&self, session: &Session, now: Seconds) -> Option<Seconds> {
        let changes = if self.is_moving(session) {
            let media = self.due(session, now).0;
            let due = session.next_due().map_or(media, |due| due.0);
            // What is overdue comes with the units that are waited for.
            let until = if due > media { due - media } else { OVERDUE_S };
            Some(now.0 + until)
        } else {
            (!self.is_settled(session)).then_some(now.0 + REFINED_S)
        };
        let forgotten = self.pointer.forgotten().map(|at| at.0);
        let forgotten = forgotten.filter(|at| *at > now.0);
        let under_way = self.navigation.is_under_way() || self.is_morphing;
        let under_way = under_way.then_some(now.0 + UNDER_WAY_S);
        let times = changes.into_iter().chain(forgotten).chain(under_way);
        times.reduce(f64::min).map(Seconds)
    }
}
