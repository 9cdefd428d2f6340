//! What does a viewer's session on a page do at each moment?
//!
//! As a window's session: time comes in as an argument, in seconds of the page's clock.

use crate::looking::Looking;
use crate::options::Options;
use crate::pack_in_parts::PackInParts;
use crate::wide::{EyeRequest, head_of, union};
use foveal_core::content::asked::{Detail, next_target};
use foveal_core::content::demand::Content;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::pack::unit::UnitId;
use foveal_core::session::actions::{Cache, Now, Pace, SessionAction, SessionEvent};
use foveal_core::session::aim::Aim;
use foveal_core::session::bounds::Bounds;
use foveal_core::session::media_clock::MediaClock;
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::Piece;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::navigation::{Navigation, Pane, Shown};
use foveal_core::view::picture::Picture;
use foveal_core::view::surface::Screen;
use foveal_render::{DrawDevice, Drawer, Gpu, Overlay, RenderError, TileStyle};
use std::sync::Arc;

/// A log grows no longer than this, in bytes.
const MOST_LOG: usize = 64 << 20;
/// What a host is thought to bring before anything came from it, in bytes per second.
const FIRST_GUESS: f64 = 1e6;
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
    pub(crate) pack: PackInParts,
    pub(crate) session: Session,
    cache: Cache<Payload>,
    pub(crate) drawer: Drawer,
    detail: Detail,
    log: Option<String>,
    bytes_per_s: f64,
    pub(crate) scene: Navigation,
    pub(crate) looking: Looking,
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
    /// What the eyes of a headset asked for last, and when.
    eyes: [Option<EyeView>; 2],
    asked: f64,
}

impl Viewer {
    /// A session with a pack of which `head` is there; without a device the CPU twin draws.
    pub fn new(head: &[u8], options: &Options, gpu: Option<Gpu>) -> Result<Self, String> {
        let pack = PackInParts::open(head, &options.name, options.screen);
        let pack = pack.map_err(|error| error.to_string())?;
        let (grid, about) = (*pack.video.grid(), pack.video.pack().description());
        let front = Radians::from_degrees(about.front_deg);
        let device = gpu.map_or(DrawDevice::Twin, DrawDevice::Gpu);
        let drawer = Drawer::new(&device, &pack.video, TileStyle::default());
        let field = Radians::from_degrees(options.field_deg);
        let detail = options.detail()?;
        let settings = SessionSettings {
            policy: detail.of(options.policy),
            bytes_per_s: Some(FIRST_GUESS),
            since: None,
            zooms: true,
            bounds: Bounds::default(),
        };
        let session = Session::new(vec![Arc::clone(&pack.video) as Arc<dyn Content>], settings);
        if !session.can(session.policy()) {
            return Err("the pack has no tables for this policy; prepare it again".to_owned());
        }
        Ok(Self {
            session,
            cache: Cache::default(),
            drawer: drawer.map_err(|error| error.to_string())?,
            detail,
            log: options.log.then(String::new),
            bytes_per_s: FIRST_GUESS,
            scene: Navigation::new(grid.surface, field).facing(front),
            pack,
            looking: Looking::default(),
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
            eyes: [None; 2],
            asked: f64::NEG_INFINITY,
        })
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
        let timeline = self.session.timeline();
        let due = timeline.tick_at(self.clock.time(now));
        let tick = self.session.shown_tick().unwrap_or(due);
        self.clock.pause(timeline.time_of(tick));
    }

    /// Goes on from another time of the content.
    pub fn seek(&mut self, to: Seconds, now: Seconds) {
        self.clock.seek(to, now);
        self.session.jump();
    }

    /// Pauses, and goes this many frames on or back.
    pub fn step_frames(&mut self, frames: i64, now: Seconds) {
        if self.is_playing() {
            self.pause(now);
        }
        let timeline = self.session.timeline();
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
            let timeline = self.session.timeline();
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
        let config = self.detail.of(policy);
        let can = self.session.can(&config);
        if can {
            self.session.change_policy(config);
        }
        can
    }

    /// Chooses at another detail.
    pub fn set_detail(&mut self, detail: Detail) {
        self.detail = detail;
        let config = detail.of(self.session.policy().policy);
        self.session.change_policy(config);
    }

    /// Goes so many target scores on, or back; what is chosen for then, or nothing where the policy
    /// has no target.
    pub fn next_target(&mut self, by: i32) -> Option<Detail> {
        let PolicyConfig { policy, target, .. } = self.session.policy();
        let has = policy.has_target();
        let next = has.then(|| Detail::Target(next_target(*target, by)))?;
        self.set_detail(next);
        Some(next)
    }

    /// What the host brings, measured.
    pub fn set_rate(&mut self, bytes_per_s: f64) {
        let other = (bytes_per_s / self.bytes_per_s - 1.0).abs() > 0.05;
        if bytes_per_s.is_finite() && bytes_per_s > 0.0 && other {
            self.bytes_per_s = bytes_per_s;
            self.session.set_bytes_per_s(bytes_per_s);
        }
    }

    /// The session log so far.
    #[must_use]
    pub fn log(&self) -> &str {
        self.log.as_deref().unwrap_or_default()
    }

    /// What draws, for people.
    #[must_use]
    pub fn device_name(&self) -> &str {
        match self.drawer.device() {
            DrawDevice::Gpu(gpu) => gpu.adapter_name(),
            DrawDevice::Twin | DrawDevice::Nothing => "the processor",
        }
    }

    /// The graphics device, where one draws.
    pub(crate) fn gpu(&self) -> Option<Gpu> {
        match self.drawer.device() {
            DrawDevice::Gpu(gpu) => Some(gpu.clone()),
            DrawDevice::Twin | DrawDevice::Nothing => None,
        }
    }

    /// Begins anew on another device.
    pub fn recover(&mut self, gpu: Gpu) -> Result<(), RenderError> {
        let (device, style) = (DrawDevice::Gpu(gpu), TileStyle::default());
        self.drawer = Drawer::new(&device, &self.pack.video, style)?;
        self.session.take(SessionEvent::DeviceLost);
        Ok(())
    }

    /// Takes the decoded picture of a frame of a unit, for which so many frames were decoded;
    /// `None` where it is damaged.
    pub fn deliver(&mut self, unit: u32, frame: u32, frames: u32, picture: Option<Picture>) {
        let unit = UnitRef {
            asset: AssetId(0),
            unit: UnitId(unit),
        };
        let piece = Piece { unit, frame };
        let event = match picture {
            Some(picture) => {
                self.cache.insert(piece, Payload::Picture(picture));
                SessionEvent::Decoded { piece, frames }
            }
            None => SessionEvent::Damaged { piece, frames },
        };
        self.session.take(event);
    }

    /// Takes a side table; the frames' times count from now on.
    pub fn add_table(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), String> {
        let added = self.pack.video.add_table(name, bytes);
        added.map_err(|error| error.to_string())?;
        self.session.retime();
        Ok(())
    }

    /// Whether it plays, or is going to with the first picture.
    pub fn is_playing(&self) -> bool {
        self.waits.unwrap_or(self.clock.is_playing())
    }

    /// Whether the content moves.
    pub fn is_moving(&self) -> bool {
        self.clock.is_playing() && !self.session.timeline().is_still()
    }

    /// Time of the content, within a round.
    pub fn time(&self, now: Seconds) -> Seconds {
        self.session.timeline().within(self.clock.time(now))
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
        let aim = self.look(now, &pane);
        let media = self.due(now);
        let step = Now {
            wall: now,
            media,
            pace: match self.is_moving() {
                true => Pace::Playing,
                false => Pace::Standing,
            },
            drawing: self.session.figures.slow_draw(self.session.period()),
            until: aim.gaze.time,
            aim,
        };
        let actions = self.session.step(&step);
        let (mut changed, wants) = self.obey(actions)?;
        let shown = self.scene.shown(&pane);
        if let Some((before, shown_before)) = &self.last {
            let moved = before.gaze.gaze_in_content != aim.gaze.gaze_in_content;
            changed |= *shown_before != shown || self.levels_shown && moved;
        }
        self.last = Some((aim, shown));
        if changed && self.session.shown_tick().is_some() {
            told |= flag::DRAW;
        }
        if wants {
            told |= flag::WANTS;
        }
        if self.session.is_hopeless() {
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

    /// Does what the session asks for; tells whether the picture changed, and whether other units
    /// are wanted.
    fn obey(&mut self, actions: Vec<SessionAction>) -> Result<(bool, bool), RenderError> {
        let (changed, left) = self.drawer.perform(actions, &mut self.cache)?;
        let mut wants = false;
        for action in left {
            match action {
                SessionAction::Want(_) => wants = true,
                SessionAction::Log(lines) => self.write(&lines),
                SessionAction::Count => {
                    let wrong = self.drawer.wrong_frame_units() as u64;
                    self.session.figures.wrong_frame_units += wrong;
                    self.session.figures.gpu_bytes = self.drawer.gpu_bytes();
                }
                _ => {}
            }
        }
        Ok((changed, wants))
    }

    fn write(&mut self, lines: &str) {
        if let Some(log) = &mut self.log
            && log.len() + lines.len() <= MOST_LOG
        {
            log.push_str(lines);
        }
    }

    fn look(&mut self, now: Seconds, pane: &Pane) -> Aim {
        let perception = &self.session.policy().perception;
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
            self.session.figures.draw_s
        } else {
            0.0
        };
        Seconds(self.clock.time(now).0 + drawing)
    }

    fn stays_at_the_end(&mut self, now: Seconds) -> bool {
        let timeline = self.session.timeline();
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
        if self.is_moving() {
            return self.session.shown_tick().is_some();
        }
        let behind = |(aim, _): &(Aim, Shown)| {
            self.session.goes_on_choosing(aim) || self.session.is_behind(aim)
        };
        self.session.is_settled()
            && !self.session.waits_for_tables()
            && !self.last.as_ref().is_none_or(behind)
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
            let period = self.session.period();
            self.session.figures.drawn(seconds, period);
        }
    }
}
