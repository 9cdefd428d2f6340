//! Which frame is on screen, and which of its units are there already?
//!
//! A session is a value: what happened goes in, and what is to be done comes out. It knows no file,
//! thread, clock or GPU. While one frame is shown the next one is decoded, what lies nearest to the
//! gaze first. At its time it is shown with what is there: a coarser level stands in for the rest,
//! and all units are of that frame. A frame that stays, paused or still, is refined until nothing
//! is missing.

mod asked;
mod presenting;
#[cfg(test)]
mod tests;
mod wanting;

use crate::content::demand::Content;
use crate::content::policy::PolicyConfig;
use crate::content::unit::UnitRef;
use crate::pack::unit::UnitId;
use crate::perception::moment::Moment;
use crate::session::actions::{Now, Pace, SessionAction, SessionEvent};
use crate::session::bounds::Bounds;
use crate::session::budget::Budget;
use crate::session::figures::Figures;
use crate::session::policy_run::{Picked, PolicyRun};
use crate::session::unit_states::{Piece, UnitState, UnitStates};
use crate::units::Seconds;
use crate::view::timeline::Timeline;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// How long a paused picture may stay as it is before the next one is shown unfinished.
const PATIENCE_S: f64 = 0.25;
/// Longest time that a frame is begun ahead of its own.
const MOST_LEAD_S: f64 = 1.0;
/// A picture is not chosen again more often than this while the view moves.
const CHOOSE_EVERY_S: f64 = 0.03;

/// What a session begins with.
#[derive(Clone, Debug)]
pub struct SessionSettings {
    /// The policy that is asked for.
    pub policy: PolicyConfig,
    /// What a link brings, in bytes a second, for policies that spend a budget; `None` where they
    /// are to choose without one.
    pub bytes_per_s: Option<f64>,
    /// Since when it brings that, by the clock of gazes; `None`: since the first choice.
    pub since: Option<Seconds>,
    /// Whether the view can be zoomed: then less is kept fine outside a narrow one.
    pub zooms: bool,
    /// Whether [`Session::see`] receives what parts of the view units would refine, once something
    /// is drawn.
    pub measures: bool,
    /// What is kept below; by default nothing that can be played comes near.
    pub bounds: Bounds,
}

/// One viewer's run over a scene.
#[derive(Debug)]
pub struct Session {
    scene: Vec<Arc<dyn Content>>,
    /// Which assets have frames in time.
    moves: Vec<bool>,
    timeline: Timeline,
    run: PolicyRun,
    states: UnitStates,
    /// What is counted.
    pub figures: Figures,
    shown: Option<Staged>,
    coming: Option<Staged>,
    bounds: Bounds,
    /// What was asked for last and did not come yet, in order.
    requested: Vec<Piece>,
    /// What is to be asked for once there is room for it, in order.
    waiting: Vec<Piece>,
    /// What was asked for last is not all that is missing.
    must_ask_anew: bool,
    /// What was decoded for the frame on screen and waits for a piece that it needs.
    held_back: HashMap<Piece, Vec<Piece>>,
    /// Bytes of what is on the GPU.
    resident_bytes: u64,
    /// What came since the last step.
    arrived: Vec<Arrived>,
    actions: Vec<SessionAction>,
    /// The viewer went elsewhere in time, and what is on screen is no longer before what comes.
    jumped: bool,
    /// How long a frame is on its way, in seconds, where that is longer than it is shown: so far
    /// ahead of its time the next one is begun.
    lead: f64,
    /// The last tick whose coarsest level is damaged.
    damaged: Option<u64>,
    /// Something was uploaded or evicted that is not counted yet.
    uncounted: bool,
    /// Whether footprints are under way.
    expects_footprints: bool,
}

/// A piece that was decoded, or found damaged, with as many frames as that took.
#[derive(Clone, Copy, Debug)]
struct Arrived {
    piece: Piece,
    frames: u32,
    is_damaged: bool,
}

/// One frame and its units.
#[derive(Clone, Debug)]
struct Staged {
    tick: u64,
    frame: u32,
    /// The frame of each asset.
    frames: Vec<u32>,
    /// What its units were chosen for last; `None` where they are to be chosen again.
    moment: Option<Moment>,
    /// When its units were last chosen.
    chosen: f64,
    /// What it is to show, of each asset the coarsest level first.
    wanted: Vec<Piece>,
    /// The same, to be looked up.
    shows: HashSet<Piece>,
    begun: f64,
    /// How long drawing takes, as far as it was known by then.
    drawing: f64,
    /// When nothing was missing any more.
    complete: Option<f64>,
}

impl Staged {
    fn is_whole(&self, states: &UnitStates) -> bool {
        self.wanted.iter().all(|piece| states.is_settled(*piece))
    }

    fn piece(&self, unit: UnitRef) -> Piece {
        Piece {
            unit,
            frame: self.frames[usize::from(unit.asset.0)],
        }
    }
}

impl Session {
    /// A session of one viewer over the assets of a scene, at least one; the first that has frames
    /// in time gives the time.
    #[must_use]
    pub fn new(scene: Vec<Arc<dyn Content>>, settings: SessionSettings) -> Self {
        let budget = settings.bytes_per_s.map(Budget::new);
        Self {
            moves: moves(&scene),
            timeline: timeline_of(&scene),
            run: PolicyRun::new(
                scene.clone(),
                settings.policy,
                budget,
                settings.since,
                settings.zooms,
                settings.measures,
            ),
            scene,
            bounds: settings.bounds,
            states: UnitStates::default(),
            figures: Figures::default(),
            shown: None,
            coming: None,
            requested: Vec::new(),
            waiting: Vec::new(),
            must_ask_anew: false,
            held_back: HashMap::new(),
            resident_bytes: 0,
            arrived: Vec::new(),
            actions: Vec::new(),
            jumped: false,
            lead: 0.0,
            damaged: None,
            uncounted: false,
            expects_footprints: false,
        }
    }

    /// Something happened. What came counts from the next step on, a table and a lost device at
    /// once.
    pub fn take(&mut self, event: SessionEvent) {
        match event {
            SessionEvent::DeviceLost => {
                self.fetch_anew();
                self.figures.lost_devices += 1;
            }
            SessionEvent::TableLoaded => {
                self.moves = moves(&self.scene);
                self.timeline = timeline_of(&self.scene);
            }
            SessionEvent::Decoded { piece, frames } => self.arrive(piece, frames, false),
            SessionEvent::Damaged { piece, frames } => self.arrive(piece, frames, true),
        }
    }

    fn arrive(&mut self, piece: Piece, frames: u32, is_damaged: bool) {
        self.requested.retain(|requested| *requested != piece);
        self.arrived.push(Arrived {
            piece,
            frames,
            is_damaged,
        });
    }

    /// Moves on to `now`: shows what is due, and orders what comes. What is to be done is handed
    /// out in order.
    pub fn step(&mut self, now: &Now) -> Vec<SessionAction> {
        self.run.stand(now.pace == Pace::Standing);
        self.take_events(now);
        if self.is_due(now) {
            self.present(now);
        }
        self.hand_out_more();
        self.order(now);
        if now.pace == Pace::Standing {
            self.settle(now);
        }
        std::mem::take(&mut self.actions)
    }

    /// Fetches everything once more: what shows it keeps nothing.
    pub fn fetch_anew(&mut self) {
        self.shown = None;
        self.coming = None;
        self.requested.clear();
        self.waiting.clear();
        self.held_back.clear();
        self.resident_bytes = 0;
        for piece in self.states.in_state(UnitState::Cached) {
            self.actions.push(SessionAction::Drop(piece));
        }
        self.states.clear();
    }

    /// Chooses by another policy from now on.
    pub fn change_policy(&mut self, config: PolicyConfig) {
        self.run.change(config);
        self.forget_choice();
    }

    /// The viewer goes elsewhere in time.
    pub fn jump(&mut self) {
        self.give_up_coming();
        self.lead = 0.0;
        self.jumped = true;
        self.damaged = None;
    }

    /// Chooses for a frame that is not shown: what is chosen later depends on what was before.
    /// Returns the units that it would show.
    pub fn pass(&mut self, tick: u64, now: &Now) -> Vec<UnitRef> {
        let frames = self.frames_of(tick);
        self.run.choose(&frames, &now.moment, now.until).units
    }

    /// Begins a frame that is shown by itself, at [`Pace::FrameByFrame`]: chooses for it once, and
    /// orders all that it takes. The steps that follow show it when it is whole.
    pub fn begin_frame(&mut self, tick: u64, now: &Now) -> Vec<SessionAction> {
        self.fetch_anew();
        let staged = self.staged(tick, now);
        self.coming = Some(self.choose(staged, now));
        self.want_missing(now);
        std::mem::take(&mut self.actions)
    }

    /// Puts what was decoded where it belongs.
    fn take_events(&mut self, now: &Now) {
        for arrived in std::mem::take(&mut self.arrived) {
            let samples = self.unit(arrived.piece).samples;
            self.figures.decoded(u64::from(arrived.frames) * samples);
            match arrived.is_damaged {
                true => self.give_up(arrived.piece),
                false => self.place(arrived.piece),
            }
        }
        let lost = |piece: &&Piece| {
            let asset = &self.scene[usize::from(piece.unit.asset.0)];
            asset.is_lost(piece.unit.unit)
        };
        let lost: Vec<Piece> = self.requested.iter().filter(lost).copied().collect();
        lost.into_iter().for_each(|piece| self.give_up(piece));
        self.hand_out_more();
        let has_no_room = self.has_no_room();
        let (states, figures) = (&self.states, &mut self.figures);
        for (staged, is_full) in [(&mut self.shown, false), (&mut self.coming, has_no_room)] {
            let Some(staged) = staged else {
                continue;
            };
            if staged.complete.is_none() && (is_full || staged.is_whole(states)) {
                staged.complete = Some(now.wall.0);
                figures.complete(now.wall.0 - staged.begun);
            }
        }
    }

    /// Keeps a piece for the frame that comes, or shows it in the one that is there.
    fn place(&mut self, piece: Piece) {
        self.requested.retain(|requested| *requested != piece);
        let wants = |staged: &Option<Staged>| {
            let staged = staged.as_ref();
            staged.is_some_and(|staged| staged.shows.contains(&piece))
        };
        let state = self.states.of(piece);
        let is_awaited = state == Some(UnitState::Requested);
        if state == Some(UnitState::Cached) {
            // It came twice, and one payload took the place of the other.
        } else if is_awaited && wants(&self.coming) {
            self.states.set(piece, UnitState::Cached);
        } else if is_awaited && wants(&self.shown) {
            self.states.set(piece, UnitState::Cached);
            self.show_arrived(piece, true);
        } else if !self.is_taken(piece) {
            self.actions.push(SessionAction::Drop(piece));
        }
    }

    /// Shows what came for the frame on screen, once all that it needs is there, and what waited
    /// for it; `makes_room` where others may have to be evicted first.
    fn show_arrived(&mut self, piece: Piece, makes_room: bool) {
        let mut open = vec![piece];
        while let Some(piece) = open.pop() {
            if self.states.of(piece) != Some(UnitState::Cached) {
                continue;
            }
            let missing = self.needs(piece).find(|it| !self.states.is_resident(*it));
            if let Some(missing) = missing {
                self.held_back.entry(missing).or_default().push(piece);
                continue;
            }
            if makes_room {
                self.make_room(piece);
            }
            self.upload(piece);
            open.extend(self.held_back.remove(&piece).unwrap_or_default());
        }
    }

    /// Whether what came of a piece is uploaded or dropped by what is to be done already: it came
    /// twice before one step, and one payload took the place of the other.
    fn is_taken(&self, piece: Piece) -> bool {
        let takes = [SessionAction::Upload(piece), SessionAction::Drop(piece)];
        self.actions.iter().any(|action| takes.contains(action))
    }

    /// Brings what was decoded onto the screen.
    fn upload(&mut self, piece: Piece) {
        let bytes = self.unit(piece).gpu_bytes;
        self.resident_bytes += bytes;
        self.uncounted = true;
        self.figures.uploaded(bytes);
        self.states.set(piece, UnitState::Resident);
        self.states.set(piece, UnitState::Shown);
        self.actions.push(SessionAction::Upload(piece));
    }

    /// Goes on without a piece: a coarser level stands in, and for the coarsest the frame before.
    fn give_up(&mut self, piece: Piece) {
        self.requested.retain(|requested| *requested != piece);
        if self.states.of(piece) != Some(UnitState::Requested) {
            return;
        }
        self.figures.damaged_units += 1;
        self.states.set(piece, UnitState::Damaged);
        let is_base = self.is_base(piece) && !self.is_spared(piece);
        let is_of_coming = self.coming.as_ref().filter(|it| it.shows.contains(&piece));
        if let Some(coming) = is_of_coming.filter(|_| is_base) {
            self.damaged = Some(coming.tick);
            self.give_up_coming();
            self.figures.damaged_frames += 1;
        }
    }

    /// Whether a damaged piece of the coarsest level leaves others that are shown without it.
    fn is_spared(&self, piece: Piece) -> bool {
        let asset = &self.scene[usize::from(piece.unit.asset.0)];
        let is_whole = |unit: UnitId| {
            let unit = UnitRef { unit, ..piece.unit };
            self.states.of(Piece { unit, ..piece }) != Some(UnitState::Damaged)
        };
        asset.stands_in_parts() && asset.base(piece.frame).into_iter().any(is_whole)
    }

    /// The frame that was coming does not come.
    fn give_up_coming(&mut self) {
        let Some(coming) = self.coming.take() else {
            return;
        };
        self.waiting.clear();
        self.must_ask_anew = true;
        self.let_go(&coming.wanted);
    }

    /// Forgets pieces that nothing shows.
    fn let_go(&mut self, pieces: &[Piece]) {
        let is_kept = |staged: &Option<Staged>, piece: &Piece| {
            let staged = staged.as_ref();
            staged.is_some_and(|staged| staged.shows.contains(piece))
        };
        for piece in pieces {
            if is_kept(&self.shown, piece) || is_kept(&self.coming, piece) {
                continue;
            }
            match self.states.of(*piece) {
                Some(UnitState::Cached) => {
                    self.actions.push(SessionAction::Drop(*piece));
                    self.states.drop(*piece);
                }
                Some(UnitState::Requested | UnitState::Damaged) => self.states.drop(*piece),
                Some(UnitState::Resident | UnitState::Shown) | None => {}
            }
        }
    }

    fn frames_of(&self, tick: u64) -> Vec<u32> {
        let frame = self.timeline.frame_of(tick);
        let frame_of = |moves: &bool| if *moves { frame } else { 0 };
        self.moves.iter().map(frame_of).collect()
    }

    /// Orders units for the frame that comes, or for the one that stays.
    fn order(&mut self, now: &Now) {
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

    fn staged(&self, tick: u64, now: &Now) -> Staged {
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
    fn differs(&self, now: &Moment, staged: &Staged) -> bool {
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
            self.shown = shown.map(|shown| self.choose(shown, now));
            self.want_missing(now);
        }
    }

    /// Chooses what a frame shows.
    fn choose(&mut self, staged: Staged, now: &Now) -> Staged {
        let Picked { units, log, line } = self.run.choose(&staged.frames, &now.moment, now.until);
        self.write(log, line);
        let wanted: Vec<Piece> = units.into_iter().map(|unit| staged.piece(unit)).collect();
        let wanted = self.fitting(wanted, now);
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

    fn write(&mut self, log: String, line: Option<crate::session::log::SessionFrame>) {
        if !log.is_empty() {
            self.actions.push(SessionAction::Log(log));
        }
        self.actions
            .extend(line.map(|line| SessionAction::Chosen(Box::new(line))));
    }

    /// Chooses again at the next step, wherever the viewer looks.
    fn forget_choice(&mut self) {
        if let Some(shown) = &mut self.shown {
            shown.chosen = f64::NEG_INFINITY;
            shown.moment = None;
        }
        self.give_up_coming();
    }

    /// Evicts what is not wanted any more once all that is wanted is there.
    fn settle(&mut self, now: &Now) {
        let Some(shown) = &mut self.shown else {
            return;
        };
        if shown.complete.is_none() && shown.is_whole(&self.states) {
            shown.complete = Some(now.wall.0);
        }
        let coming = self.coming.as_ref();
        let is_awaited = |piece: &Piece| coming.is_some_and(|it| it.shows.contains(piece));
        let stale = |piece: &Piece| !shown.shows.contains(piece) && !is_awaited(piece);
        if shown.complete.is_some() && self.states.resident().iter().any(stale) {
            self.evict_others();
        }
        if self.uncounted {
            self.count();
        }
    }
}

/// Which assets have frames in time.
fn moves(scene: &[Arc<dyn Content>]) -> Vec<bool> {
    let moves = |asset: &Arc<dyn Content>| !asset.timeline().is_still();
    scene.iter().map(moves).collect()
}

fn timeline_of(scene: &[Arc<dyn Content>]) -> Timeline {
    let mut timelines = scene.iter().map(|asset| asset.timeline());
    let moving = timelines.find(|timeline| !timeline.is_still());
    moving.unwrap_or_else(|| Timeline::new(&[0], Seconds(1.0)))
}
