//! What does a viewer's session on a page do at each moment?
//!
//! As a window's session: time comes in as an argument, in seconds of the page's clock.

use crate::choice::WebChoice;
use crate::easel::WebEasel;
use crate::feed::WebFeed;
use crate::looking::Looking;
use crate::options::Options;
use crate::shelf::Shelf;
use crate::wide::{EyeRequest, head_of, union};
use foveal_core::content::asked::{Detail, next_target};
use foveal_core::content::policy::Policy;
use foveal_core::session::aim::Aim;
use foveal_core::session::figures::Figures;
use foveal_core::session::media_clock::MediaClock;
use foveal_core::session::playback::{Delivery, Now, Stage};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::navigation::{Navigation, Pane, Shown};
use foveal_core::view::surface::Screen;
use foveal_render::{Overlay, RenderError};
use std::cell::RefCell;
use std::rc::Rc;

/// Radius of the ring round the gaze, in degrees: the fovea.
const FOVEA_DEG: f64 = 2.5;
/// How often a headset's eyes must ask for the levels to follow them, in seconds.
const HEADSET_HOLDS_S: f64 = 0.5;

/// What a step tells, as bits.
pub mod flag {
    /// The picture changed: draw.
    pub const DRAW: u32 = 1;
    /// What is on screen is what is wanted, with nothing missing.
    pub const SETTLED: u32 = 2;
    /// Other tiles are wanted.
    pub const WANTS: u32 = 4;
    /// Content moves, or something still changes: step again at the next picture of the screen.
    pub const AGAIN: u32 = 8;
    /// The end was reached, and it stays there.
    pub const ENDED: u32 = 16;
    /// No frame at all can be shown.
    pub const HOPELESS: u32 = 32;
}

/// A viewer's session.
pub struct Viewer {
    pub(crate) shelf: Rc<RefCell<Shelf>>,
    pub(crate) stage: Stage<WebFeed, WebEasel>,
    pub(crate) choice: WebChoice,
    pub(crate) scene: Navigation,
    pub(crate) looking: Looking,
    pub(crate) figures: Figures,
    clock: MediaClock,
    /// Whether it plays once the first picture is on the canvas: time begins with that. `None`
    /// from then on.
    waits: Option<bool>,
    size: [u32; 2],
    screen_size: [u32; 2],
    screen: Screen,
    once: bool,
    ended: bool,
    pub(crate) coarse: bool,
    pub(crate) levels_shown: bool,
    /// What the last step was made for.
    last: Option<(Aim, Shown)>,
    version: u32,
    /// What the eyes of a headset asked for last, and when.
    eyes: [Option<EyeView>; 2],
    asked: f64,
}

impl Viewer {
    /// A session with a pack of which `head` is there; without a device the CPU twin draws.
    pub fn new(
        head: &[u8],
        options: &Options,
        gpu: Option<foveal_render::Gpu>,
    ) -> Result<Self, String> {
        let shelf = Shelf::new(head, options.screen).map_err(|error| error.to_string())?;
        let (grid, timeline) = (shelf.grid, shelf.timeline());
        let about = shelf.pack.description();
        let (colour, front) = (about.colour, Radians::from_degrees(about.front_deg));
        let easel = WebEasel::new(gpu, &grid, colour).map_err(|error| error.to_string())?;
        let field = Radians::from_degrees(options.field_deg);
        let shelf = Rc::new(RefCell::new(shelf));
        let (name, detail) = (&options.name, options.detail()?);
        let mut viewer = Self {
            choice: WebChoice::new(Rc::clone(&shelf), name, detail, options.log),
            stage: Stage::new(grid, timeline, WebFeed::default(), easel),
            scene: Navigation::new(grid.surface, field).facing(front),
            shelf,
            looking: Looking::default(),
            figures: Figures::default(),
            clock: MediaClock::default(),
            waits: Some(!options.paused),
            size: options.size,
            screen_size: options.screen_size,
            screen: options.screen,
            once: options.once,
            ended: false,
            coarse: options.coarse,
            levels_shown: false,
            last: None,
            version: 0,
            eyes: [None; 2],
            asked: f64::NEG_INFINITY,
        };
        if !viewer.choice.change(options.policy) {
            return Err("the pack has no tables for this policy; prepare it again".to_owned());
        }
        Ok(viewer)
    }

    /// The canvas, and where it is.
    pub fn pane(&self) -> Pane {
        Pane::new(self.size, self.screen_size, self.screen)
    }

    /// The canvas has other pixels.
    pub fn resize(&mut self, size: [u32; 2]) {
        self.size = size.map(|side| side.max(1));
    }

    /// The first picture is on the canvas: time begins, where it plays.
    pub fn begin(&mut self, now: Seconds) {
        if self.waits.take() == Some(true) {
            self.clock.play(now);
        }
    }

    /// Plays from where it is, or from the beginning once it ended.
    pub fn play(&mut self, now: Seconds) {
        if let Some(plays) = &mut self.waits {
            *plays = true;
            return;
        }
        if std::mem::take(&mut self.ended) {
            self.seek(Seconds(0.0), now);
        }
        self.clock.play(now);
    }

    /// Stays at the frame that is on screen.
    pub fn pause(&mut self, now: Seconds) {
        if let Some(plays) = &mut self.waits {
            *plays = false;
            return;
        }
        let timeline = self.stage.timeline();
        let due = timeline.tick_at(self.clock.time(now));
        let tick = self.stage.shown_tick().unwrap_or(due);
        self.clock.pause(timeline.time_of(tick));
    }

    /// Goes on from another time of the content.
    pub fn seek(&mut self, to: Seconds, now: Seconds) {
        self.clock.seek(to, now);
        self.stage.jump();
    }

    /// Pauses, and goes this many frames on or back.
    pub fn step_frames(&mut self, frames: i64, now: Seconds) {
        if self.is_playing() {
            self.pause(now);
        }
        let timeline = self.stage.timeline();
        let tick = timeline.tick_at(self.clock.time(now));
        // Before the first frame comes the last.
        let around = if frames < 0 && tick < frames.unsigned_abs() {
            timeline.frames()
        } else {
            0
        };
        let to = timeline.time_of((tick + around).saturating_add_signed(frames));
        self.seek(to, now);
    }

    /// Keeps to what is heard.
    pub fn heard(&mut self, heard: Seconds, now: Seconds) {
        if self.is_moving() {
            // Sound counts from the beginning of a round, the clock goes on through all.
            let timeline = self.stage.timeline();
            let time = self.clock.time(now);
            let begin = time.0 - timeline.within(time).0;
            let length = timeline.length().0;
            let near = [begin - length, begin, begin + length].map(|round| round + heard.0);
            let off = |at: &f64| (at - time.0).abs();
            let nearest = near.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            self.clock.follow(Seconds(nearest.unwrap_or(heard.0)), now);
        }
    }

    /// Chooses by another policy; `false` where the pack lacks what it needs.
    pub fn set_policy(&mut self, policy: Policy) -> bool {
        let can = self.choice.change(policy);
        if can {
            self.stage.forget_choice();
        }
        can
    }

    /// Chooses at another detail.
    pub fn set_detail(&mut self, detail: Detail) {
        self.choice.set_detail(detail);
        self.stage.forget_choice();
    }

    /// Goes so many target scores on, or back; what is chosen for then, or nothing where the policy
    /// has no target.
    pub fn next_target(&mut self, by: i32) -> Option<Detail> {
        let config = self.choice.config();
        let has = config.policy.has_target();
        let next = has.then(|| Detail::Target(next_target(config.target, by)))?;
        self.set_detail(next);
        Some(next)
    }

    /// Takes a side table; the frames' times count from now on.
    pub fn add_table(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), String> {
        let added = self.shelf.borrow_mut().add_table(name, bytes);
        added.map_err(|error| error.to_string())?;
        let timeline = self.shelf.borrow().timeline();
        self.stage.retime(timeline);
        Ok(())
    }

    /// Whether it plays, or is going to with the first picture.
    pub fn is_playing(&self) -> bool {
        self.waits.unwrap_or(self.clock.is_playing())
    }

    /// Whether the content moves.
    pub fn is_moving(&self) -> bool {
        self.clock.is_playing() && !self.stage.timeline().is_still()
    }

    /// Time of the content, within a round.
    pub fn time(&self, now: Seconds) -> Seconds {
        self.stage.timeline().within(self.clock.time(now))
    }

    /// What the last step was made for.
    pub(crate) fn aim(&self) -> Option<&Aim> {
        self.last.as_ref().map(|(aim, _)| aim)
    }

    /// Looks where the viewer looks and moves the stage on; tells what of [`flag`] is so.
    pub fn step(&mut self, now: Seconds) -> Result<u32, RenderError> {
        let mut told = if self.stays_at_the_end(now) {
            flag::ENDED
        } else {
            0
        };
        let pane = self.pane();
        self.give_up_lost();
        let aim = self.look(now, &pane);
        let media = self.due(now);
        let step = Now {
            wall: now,
            media,
            playing: self.is_moving(),
            drawing: self.figures.slow_draw(self.stage.period()),
            aim,
        };
        let mut changed = self
            .stage
            .step(&step, &mut self.choice, &mut self.figures)?;
        let shown = self.scene.shown(&pane);
        if let Some((before, shown_before)) = &self.last {
            let moved = before.gaze.gaze_in_content != aim.gaze.gaze_in_content;
            changed |= *shown_before != shown || self.levels_shown && moved;
        }
        self.last = Some((aim, shown));
        if changed && self.stage.shown_tick().is_some() {
            told |= flag::DRAW;
        }
        if self.version != self.stage.feed.version {
            self.version = self.stage.feed.version;
            told |= flag::WANTS;
        }
        if self.stage.is_hopeless(&self.figures) {
            told |= flag::HOPELESS;
        }
        let settled = self.is_settled();
        if settled {
            told |= flag::SETTLED;
        }
        let forgets = self.looking.pointer.forgotten();
        let forgets = forgets.is_some_and(|at| at.0 > now.0 - 0.1);
        if !settled || self.is_moving() || self.looking.moves() || forgets {
            told |= flag::AGAIN;
        }
        Ok(told)
    }

    /// Tiles that the index does not tell of, because their page is damaged, do not come.
    fn give_up_lost(&mut self) {
        let shelf = self.shelf.borrow();
        if shelf.damaged_pages.is_empty() {
            return;
        }
        let wanted = self.stage.feed.wanted().iter().copied();
        let lost = |(tile, frame): &(_, u32)| shelf.is_lost(shelf.pack.unit(*tile, *frame));
        let lost: Vec<_> = wanted.filter(lost).collect();
        for (tile, frame) in lost {
            self.stage.feed.deliver(Delivery {
                tile,
                frame,
                decoded: 0,
                picture: None,
            });
        }
    }

    fn look(&mut self, now: Seconds, pane: &Pane) -> Aim {
        let perception = &self.choice.config().perception;
        match self.eyes {
            [Some(left), right] if now.0 - self.asked < HEADSET_HOLDS_S => {
                let view = union(&left, &right.unwrap_or(left));
                let head = head_of(&left.axes);
                self.looking.aim_in_headset(now, &view, head, perception)
            }
            _ => self.looking.aim(now, &mut self.scene, pane, perception),
        }
    }

    /// The moment of the content to show: the one that it is when it has been drawn.
    fn due(&self, now: Seconds) -> Seconds {
        let drawing = if self.is_moving() {
            self.figures.draw_s
        } else {
            0.0
        };
        Seconds(self.clock.time(now).0 + drawing)
    }

    fn stays_at_the_end(&mut self, now: Seconds) -> bool {
        let timeline = self.stage.timeline();
        let over = self.clock.time(now).0 >= timeline.length().0;
        if self.once && over && self.clock.is_playing() {
            let last = timeline.time_of(timeline.frames() - 1);
            self.clock.pause(last);
            self.ended = true;
            return true;
        }
        false
    }

    /// Whether nothing on screen is going to change by itself, or it plays.
    pub fn is_settled(&self) -> bool {
        use foveal_core::session::playback::Chooses;
        if self.is_moving() {
            return self.stage.shown_tick().is_some();
        }
        let behind = |(aim, _): &(Aim, Shown)| {
            self.choice.differs(aim, aim) || self.stage.is_behind(aim, &self.choice)
        };
        self.stage.is_settled() && !self.choice.waits() && !self.last.as_ref().is_none_or(behind)
    }

    /// What of the canvas is picture, and what it shows.
    pub fn shown(&self) -> Shown {
        self.scene.shown(&self.pane())
    }

    /// What is drawn over the picture.
    pub fn marks(&self) -> Option<Overlay> {
        let (aim, shown) = self.last.as_ref().filter(|_| self.levels_shown)?;
        let direction = aim.gaze.gaze_in_content;
        let place = shown.view.place(direction).unwrap_or([-1e6; 2]);
        let seen = shown.view.seen_direction(direction).unwrap_or(direction);
        let ppd = shown.view.as_seen().ppd_towards(seen).0;
        Some(Overlay {
            gaze: place.map(|place| place as f32),
            gaze_radius: (ppd * FOVEA_DEG) as f32,
            ..Overlay::default()
        })
    }

    /// The view of an eye of a headset, which levels follow from now on; `None` where the numbers
    /// are none of an eye.
    pub(crate) fn eye_view(&mut self, request: &EyeRequest, now: Seconds) -> Option<EyeView> {
        let view = request.view()?;
        let right = usize::from(request.eye == foveal_core::view::surface::Eye::Right);
        self.eyes[right] = Some(view);
        self.asked = now.0;
        Some(view)
    }

    /// What is to be shown was drawn in this many seconds.
    pub fn drawn(&mut self, seconds: f64) {
        if self.is_moving() {
            self.figures.drawn(seconds, self.stage.period());
        }
    }
}
