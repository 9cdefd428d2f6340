//! Which frame is on screen, and which of its units are there already?
//!
//! A session is a value: what happened goes in, and what is to be done comes out. It knows no file,
//! thread, clock or GPU. While one frame is shown the next one is decoded, what lies nearest to the
//! gaze first. At its time it is shown with what is there: a coarser level stands in for the rest,
//! and all units are of that frame. A frame that stays, paused or still, is refined until nothing
//! is missing.

mod arriving;
mod asked;
mod choosing;
mod presenting;
#[cfg(test)]
mod tests;
mod wanting;

use crate::content::demand::Content;
use crate::content::policy::PolicyConfig;
use crate::content::unit::UnitRef;
use crate::perception::moment::Moment;
use crate::session::actions::{Now, Pace, SessionAction, SessionEvent};
use crate::session::bounds::Bounds;
use crate::session::budget::Budget;
use crate::session::client_memory::ClientMemory;
use crate::session::figures::Figures;
use crate::session::policy_run::PolicyRun;
use crate::session::unit_states::{Piece, UnitState, UnitStates};
use crate::units::Seconds;
use crate::view::timeline::Timeline;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

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
    /// Whether [`SessionEvent::Measured`] reports what parts of the view units would refine, once
    /// something is drawn.
    pub measures: bool,
    /// What is kept below; by default nothing that can be played comes near.
    pub bounds: Bounds,
}

/// One viewer's run over a scene.
///
/// A session opens no file, waits for nothing and reads no clock. Its caller uses methods
/// of four groups; a round is events, then the step.
///
/// **Events** report what happened: [`Self::take`], any number before a step, in the order in
/// which they happened. What was decoded or found damaged counts from the next step on, all else
/// at once. [`SessionEvent::Mounted`] and [`SessionEvent::BeganAt`] are for the time before
/// anything is chosen. What draws reports [`SessionEvent::GpuRoom`] and [`SessionEvent::Measured`]
/// before the step that is to choose by them, and [`SessionEvent::Evicted`] before the next step:
/// what a step shows again must still be there.
///
/// **Commands** do in one call what no round does. [`Self::fetch_anew`] forgets what is on its way
/// and on the GPU, after something that draws threw away what it held; whatever still comes of it
/// is dropped, and what was fetched stays in main memory. [`Self::pass`] chooses for a frame that
/// is not shown. [`Self::begin_frame`] begins a frame that is made by itself, at
/// [`Pace::FrameByFrame`].
///
/// **The step**, [`Self::step`], moves on to a moment and returns what is to be done. These
/// actions are carried out in their order, and all of them: a later one stands on those before.
/// [`SessionAction::Want`] takes the place of the one before it: what is not in it any more need
/// not come, and may all the same. Each piece that came is kept outside until an action uploads
/// or drops it. What is done need not be reported, but for [`SessionAction::Count`], which
/// [`SessionEvent::Counted`] answers.
///
/// **Getters** change nothing, and say how it stands after the last event, command or step.
///
/// *Time.* Every time is an argument, of [`Now`]. `wall` never runs backwards; `media` does after
/// [`SessionEvent::Jumped`]; the gaze has its own clock, by which bytes are spent. A session does
/// not ask to be woken. While content plays it is stepped at each picture of the screen, or at
/// [`Self::next_due`]; while it stands, again after events, when [`Self::is_behind`] where the
/// viewer looks, and until it [`Self::is_settled`].
///
/// *The same calls give the same actions*, bit for bit, on every machine.
///
/// ```
/// use foveal_core::session::actions::{Now, SessionAction, SessionEvent};
/// use foveal_core::session::session::Session;
///
/// /// A round before a side that decodes in no time, and draws nothing.
/// fn round(session: &mut Session, now: &Now) {
///     for action in session.step(now) {
///         if let SessionAction::Want(pieces) = action {
///             for piece in pieces {
///                 session.take(SessionEvent::Decoded { piece, frames: 1 });
///             }
///         }
///     }
/// }
/// ```
#[derive(Debug)]
pub struct Session {
    scene: Vec<Arc<dyn Content>>,
    /// Which assets have frames in time.
    moves: Vec<bool>,
    timeline: Timeline,
    run: PolicyRun,
    states: UnitStates,
    figures: Figures,
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
    /// What stays there without being shown, by the choice at which it left the picture.
    staying: HashMap<Piece, u64>,
    /// What was fetched and is still there.
    memory: ClientMemory,
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
    /// Whether what was drawn is being measured.
    is_measuring: bool,
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
            staying: HashMap::new(),
            memory: ClientMemory::new(settings.bounds.client),
            arrived: Vec::new(),
            actions: Vec::new(),
            jumped: false,
            lead: 0.0,
            damaged: None,
            uncounted: false,
            is_measuring: false,
        }
    }

    /// Something happened. What came counts from the next step on, all else at once.
    ///
    /// # Panics
    /// What was measured must be of an asset of the scene.
    pub fn take(&mut self, event: SessionEvent) {
        match event {
            SessionEvent::Decoded { piece, frames } => self.arrive(piece, frames, false),
            SessionEvent::Damaged { piece, frames } => self.arrive(piece, frames, true),
            SessionEvent::TableLoaded => {
                self.moves = moves(&self.scene);
                self.timeline = timeline_of(&self.scene);
            }
            SessionEvent::DeviceLost => {
                self.fetch_anew();
                self.figures.lost_devices += 1;
            }
            SessionEvent::PolicyChosen(config) => {
                self.run.change(*config);
                self.forget_choice();
            }
            SessionEvent::LinkRate { bytes_per_s } => self.run.set_bytes_per_s(bytes_per_s),
            SessionEvent::Charged { bytes } => self.run.charge(bytes),
            SessionEvent::BeganAt(time) => self.run.begin_at(time),
            SessionEvent::Mounted(panels) => self.run.show_on(panels),
            SessionEvent::GpuRoom { bytes } => {
                self.bounds.gpu = bytes;
                self.leave_room(0);
            }
            SessionEvent::Evicted(pieces) => pieces.into_iter().for_each(|it| self.lose(it)),
            SessionEvent::Jumped => {
                self.give_up_coming();
                self.lead = 0.0;
                self.jumped = true;
                self.damaged = None;
            }
            SessionEvent::Measuring { is_under_way } => self.is_measuring = is_under_way,
            SessionEvent::Measured { asset, measured } => self.run.see(asset, measured),
            SessionEvent::Drawn { took } => {
                let period = self.period();
                self.figures.drawn(took.0, period);
            }
            SessionEvent::Counted {
                gpu_bytes,
                wrong_frame_units,
            } => {
                self.figures.gpu_bytes = gpu_bytes;
                self.figures.wrong_frame_units += wrong_frame_units;
            }
            SessionEvent::GpuErrors { count } => self.figures.gpu_errors += count,
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

    /// Fetches everything once more, after what draws has lost all that it held.
    pub fn fetch_anew(&mut self) {
        self.shown = None;
        self.coming = None;
        self.requested.clear();
        self.waiting.clear();
        self.held_back.clear();
        self.resident_bytes = 0;
        self.staying.clear();
        for piece in self.states.in_state(UnitState::Cached) {
            self.actions.push(SessionAction::Drop(piece));
        }
        self.states.clear();
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
