//! How does a pack play on a page?
//!
//! Time comes in as an argument, in seconds of the page's clock.

use crate::headset_eye::EyeRequest;
use crate::looking::Looking;
use crate::options::Options;
use crate::pack_in_parts::PackInParts;
use foveal_core::content::asked::{Detail, next_target};
use foveal_core::content::opened::Opened;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::unit::{AssetId, UnitRef};
use foveal_core::content::video::calibration::density_of;
use foveal_core::gaze::sample::HeadPose;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Cache, Now, SessionAction, SessionEvent};
use foveal_core::session::session::{Session, SessionSettings};
use foveal_core::session::unit_states::Piece;
use foveal_core::session::viewer::{AtEnd, Heard, Viewer, ViewerSettings};
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::flight::Steering;
use foveal_core::view::navigation::{Pane, Shown};
use foveal_core::view::surface::Screen;
use foveal_render::{DrawDevice, Drawer, Gpu, Overlay, RenderError};

/// A log grows no longer than this, in bytes.
const MOST_LOG: usize = 64 << 20;
/// What a host is thought to bring before anything came from it, in bytes per second.
const FIRST_GUESS: f64 = 1e6;
/// How often a headset's eyes must ask for the levels to follow them, in seconds.
const HEADSET_HOLDS_S: f64 = 0.5;

/// What a step returns, as bits.
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

/// A session with what draws for it on a page, and its viewer.
pub struct PagePlayer {
    pub(crate) pack: PackInParts,
    pub(crate) session: Session,
    cache: Cache<Payload>,
    pub(crate) drawer: Drawer,
    detail: Detail,
    log: Option<String>,
    /// A line was left out.
    log_is_full: bool,
    bytes_per_s: f64,
    /// Time begins with the first picture on the canvas.
    pub(crate) viewer: Viewer,
    pub(crate) looking: Looking,
    size: [u32; 2],
    screen_size: [u32; 2],
    screen: Screen,
    pub(crate) coarse: bool,
    pub(crate) levels_shown: bool,
    /// What the eyes of a headset asked for last, and when.
    eyes: [Option<EyeView>; 2],
    asked: f64,
}

impl PagePlayer {
    /// A session with a pack of which `head` is there, and `rest` as [`opening`](crate::opening)
    /// asks for it; without a device the CPU twin draws.
    pub fn new(
        head: &[u8],
        rest: &[u8],
        options: &Options,
        gpu: Option<Gpu>,
    ) -> Result<Self, String> {
        let pack = PackInParts::open(head, rest, &options.name, options.screen);
        let pack = pack.map_err(|error| error.to_string())?;
        let device = gpu.map_or(DrawDevice::Twin, DrawDevice::Gpu);
        let drawer = pack.drawer(&device);
        let navigation = pack.navigation(options);
        let detail = options.detail()?;
        let settings = SessionSettings {
            policy: detail.of(options.policy),
            bytes_per_s: Some(FIRST_GUESS),
            since: None,
            zooms: true,
            measures: pack.content.video().is_none(),
            bounds: pack.bounds(),
        };
        let session = Session::new(vec![pack.content.content()], settings);
        refuse_policy(&pack, &session, session.policy())?;
        let viewer = ViewerSettings {
            plays: !options.paused,
            at_end: match options.once {
                true => AtEnd::StaysUntilPlayed,
                false => AtEnd::GoesRound,
            },
            holds_early: false,
        };
        Ok(Self {
            session,
            cache: Cache::default(),
            drawer: drawer.map_err(|error| error.to_string())?,
            detail,
            log: options.log.then(String::new),
            log_is_full: false,
            bytes_per_s: FIRST_GUESS,
            viewer: Viewer::new(navigation, viewer),
            pack,
            looking: Looking::default(),
            size: options.size,
            screen_size: options.screen_size,
            screen: options.screen,
            coarse: options.coarse,
            levels_shown: false,
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

    /// Plays from where it is, or from the beginning once it ended.
    pub fn play(&mut self, now: Seconds) {
        self.viewer.play(&mut self.session, now);
    }

    /// Stays at the frame that is on screen.
    pub fn pause(&mut self, now: Seconds) {
        self.viewer.pause(&self.session, now);
    }

    /// Goes on from another time of the content.
    pub fn seek(&mut self, to: Seconds, now: Seconds) {
        self.viewer.seek(&mut self.session, to, now);
    }

    /// Pauses, and goes this many frames on or back.
    pub fn step_frames(&mut self, frames: i64, now: Seconds) {
        self.viewer.step_frames(&mut self.session, frames, now);
    }

    /// Keeps to what is heard, a time of a round.
    pub fn heard(&mut self, heard: Seconds, now: Seconds) {
        self.viewer.hear(&self.session, Heard::InRound(heard), now);
    }

    /// Chooses by another policy; says why where that cannot be.
    pub fn set_policy(&mut self, policy: Policy) -> Result<(), String> {
        let config = self.detail.of(policy);
        refuse_policy(&self.pack, &self.session, &config)?;
        self.session
            .take(SessionEvent::PolicyChosen(Box::new(config)));
        Ok(())
    }

    /// The policy that needs fewer pixels for the target of the present one, by the content's
    /// calibration; `None` until that has been loaded, and where there is none.
    #[must_use]
    pub fn cheaper_policy(&self) -> Option<Policy> {
        let video = self.pack.content.video()?;
        let target = self.session.policy().target?;
        let density = density_of(&video.grid().surface, &self.shown().view);
        let (rule, _) = video.calibration()?.cheaper(target, Some(density))?;
        Some(Policy::judged_for(rule))
    }

    /// Chooses at another detail.
    pub fn set_detail(&mut self, detail: Detail) {
        self.detail = detail;
        let config = detail.of(self.session.policy().policy);
        if self.session.can(&config) {
            self.session
                .take(SessionEvent::PolicyChosen(Box::new(config)));
        }
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
            self.session.take(SessionEvent::LinkRate { bytes_per_s });
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

    /// Starts over on another device.
    pub fn recover(&mut self, gpu: Gpu) -> Result<(), RenderError> {
        self.drawer = self.pack.drawer(&DrawDevice::Gpu(gpu))?;
        self.session.take(SessionEvent::DeviceLost);
        Ok(())
    }

    /// Takes what was decoded of a frame of a unit, for which so many frames were decoded; `None`
    /// where it is damaged.
    pub fn deliver(&mut self, unit: u32, frame: u32, frames: u32, decoded: Option<Payload>) {
        let unit = UnitRef {
            asset: AssetId::ONLY,
            unit: UnitId(unit),
        };
        let piece = Piece { unit, frame };
        let event = match decoded {
            Some(payload) => {
                self.cache.insert(piece, payload);
                SessionEvent::Decoded { piece, frames }
            }
            None => SessionEvent::Damaged { piece, frames },
        };
        self.session.take(event);
    }

    /// Reads a chunk that [`Kind::Whole`](crate::Kind::Whole) asked for; says what is damaged of
    /// it, and has taken nothing then.
    pub fn deliver_whole(&mut self, unit: u32, chunk: &[u8]) -> Result<(), String> {
        let payload = self.pack.payload(UnitId(unit), chunk);
        let payload = payload.map_err(|error| error.to_string())?;
        self.deliver(unit, 0, 1, Some(payload));
        Ok(())
    }

    /// Takes a side table; the frames' times count from now on.
    pub fn add_table(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), String> {
        if let Some(video) = self.pack.content.video() {
            let added = video.add_table(name, bytes);
            added.map_err(|error| error.to_string())?;
            self.session.take(SessionEvent::TableLoaded);
        }
        Ok(())
    }

    /// Flies, or no longer flies, through a scene along a direction of the head: to the right, up
    /// and ahead, or against these where a number is negative.
    pub fn fly(&mut self, towards: [f64; 3], is_held: bool, is_hurried: bool, now: Seconds) {
        let pane = self.pane();
        let navigation = &mut self.viewer.navigation;
        let steering = navigation.steering().with(towards, is_held);
        navigation.steer(steering.hurried(is_hurried), &pane, now);
    }

    /// Stays where it is in a scene.
    pub fn stop_flying(&mut self, now: Seconds) {
        let pane = self.pane();
        let navigation = &mut self.viewer.navigation;
        navigation.steer(Steering::default(), &pane, now);
    }

    /// Whether the content moves.
    pub fn is_moving(&self) -> bool {
        self.viewer.is_moving(&self.session)
    }

    /// Time of the content, within a round.
    pub fn time(&self, now: Seconds) -> Seconds {
        self.session.timeline().within(self.viewer.time(now))
    }

    /// Looks where the viewer looks and moves the session on; returns bits of [`flag`].
    pub fn step(&mut self, now: Seconds) -> Result<u32, RenderError> {
        let mut told = if self.viewer.stay_at_the_end(&self.session, now) {
            flag::ENDED
        } else {
            0
        };
        let pane = self.pane();
        self.viewer.navigation.fly_on(&pane, now);
        let moment = self.look(now, &pane);
        if let Some(room) = self.drawer.expect(&moment.views)? {
            self.session.take(room);
        }
        self.measure(&moment)?;
        if let Some(evicted) = self.drawer.take_evicted() {
            self.session.take(evicted);
        }
        let step = self.viewer.now(&self.session, &moment, now);
        let actions = self.session.step(&step);
        let (mut changed, wants) = self.obey(actions, &step)?;
        // What came is measured while the next picture is awaited.
        self.measure(&moment)?;
        self.viewer.set_morphing(self.drawer.is_morphing());
        changed |= self.viewer.stepped(moment, &pane, self.levels_shown);
        if changed && self.session.shown_tick().is_some() {
            told |= flag::DRAW;
        }
        if wants {
            told |= flag::WANTS;
        }
        if self.session.is_hopeless() {
            told |= flag::HOPELESS;
        }
        if self.is_settled() {
            told |= flag::SETTLED;
        }
        if self.viewer.next_step(&self.session, now).is_some() || self.looking.moves() {
            told |= flag::AGAIN;
        }
        Ok(told)
    }

    /// Reports to the session what was measured of what is drawn.
    fn measure(&mut self, moment: &Moment) -> Result<(), RenderError> {
        let events = self.drawer.measure(&self.session, moment)?;
        events
            .into_iter()
            .for_each(|event| self.session.take(event));
        Ok(())
    }

    /// Does what the session asks for; returns whether the picture changed, and whether other
    /// units are wanted.
    fn obey(
        &mut self,
        actions: Vec<SessionAction>,
        step: &Now,
    ) -> Result<(bool, bool), RenderError> {
        let (changed, left) = self.drawer.perform(actions, &mut self.cache, step)?;
        let mut wants = false;
        for action in left {
            match action {
                SessionAction::Want(_) => wants = true,
                SessionAction::Log(lines) => self.write(&lines),
                SessionAction::Count => self.session.take(self.drawer.count()),
                _ => {}
            }
        }
        Ok((changed, wants))
    }

    fn write(&mut self, lines: &str) {
        if let Some(log) = &mut self.log {
            // A line after one that is missing would not replay.
            self.log_is_full |= log.len() + lines.len() > MOST_LOG;
            if !self.log_is_full {
                log.push_str(lines);
            }
        }
    }

    fn look(&mut self, now: Seconds, pane: &Pane) -> Moment {
        let perception = &self.session.policy().perception;
        match self.eyes {
            [Some(left), right] if now.0 - self.asked < HEADSET_HOLDS_S => {
                let head = HeadPose::of(&left.axes);
                let views = [Some(left), right].into_iter().flatten().collect();
                self.looking.moment_in_headset(now, views, head, perception)
            }
            _ => self.looking.moment(now, &mut self.viewer, pane, perception),
        }
    }

    /// Whether nothing on screen is going to change by itself, or it plays.
    pub fn is_settled(&self) -> bool {
        self.viewer.is_settled(&self.session)
    }

    /// What of the canvas is picture, and what it shows.
    pub fn shown(&self) -> Shown {
        self.viewer.shown(&self.pane())
    }

    /// What is drawn over the picture.
    pub fn marks(&self) -> Option<Overlay> {
        let fovea = self.viewer.fovea().filter(|_| self.levels_shown)?;
        Some(Overlay {
            gaze: fovea.place.map(|place| place as f32),
            gaze_radius: fovea.radius as f32,
            ..Overlay::default()
        })
    }

    /// The view of an eye of a headset, which levels follow from now on; `None` where the numbers
    /// do not describe an eye.
    pub(crate) fn eye_view(&mut self, request: &EyeRequest, now: Seconds) -> Option<EyeView> {
        let start = match &self.pack.content {
            Opened::Video(_) => None,
            Opened::Scene(_) => Some(self.shown().view.position),
        };
        let view = request.view(start)?;
        let right = usize::from(request.eye == foveal_core::view::surface::Eye::Right);
        self.eyes[right] = Some(view);
        self.asked = now.0;
        Some(view)
    }

    /// What is to be shown was drawn in this many seconds.
    pub fn drawn(&mut self, seconds: f64) {
        self.viewer.drawn(&mut self.session, Some(Seconds(seconds)));
    }
}

/// Says why a pack cannot be chosen by a policy.
fn refuse_policy(
    pack: &PackInParts,
    session: &Session,
    config: &PolicyConfig,
) -> Result<(), String> {
    if let Some(why) = pack.content.why_not(config.policy) {
        return Err(format!("policy {}: {why}", config.policy.name()));
    }
    match session.can(config) {
        true => Ok(()),
        false => Err("the pack has no tables for this policy; prepare it again".to_owned()),
    }
}
