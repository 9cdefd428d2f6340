//! How does a pack play on a page?
//!
//! Time comes in as an argument, in seconds of the page's clock.

use crate::gaze_source::PageGazeSource;
use crate::headset_eye::EyeRequest;
use crate::opening::OpenPack;
use crate::options::Options;
use crate::pack_in_parts::PackInParts;
use crate::stretches::Fetching;
use foveal_core::content::payload::Payload;
use foveal_core::content::policy::asked::{Detail, next_target};
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::content::unit::AssetId;
use foveal_core::content::video::calibration::density_of;
use foveal_core::gaze::sample::HeadPose;
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::SessionEvent;
use foveal_core::session::session::SessionSettings;
use foveal_core::session::unit_states::Piece;
use foveal_core::session::viewer::{AtEnd, Heard, Viewer, ViewerSettings};
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::flight::Steering;
use foveal_core::view::navigation::{Pane, Shown};
use foveal_core::view::surface::Screen;
use foveal_play::{Outside, PlayError, Player, Stepped};
use foveal_render::{DrawDevice, Gpu, Overlay, RenderError};

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

/// A pack that plays on a page, and its viewer.
pub struct PagePlayer {
    pub(crate) pack: PackInParts,
    /// What plays it: what the page decodes is handed over.
    pub(crate) play: Player,
    detail: Detail,
    log: Option<String>,
    /// A line was left out.
    log_is_full: bool,
    bytes_per_s: f64,
    /// Time begins with the first picture on the canvas.
    pub(crate) viewer: Viewer,
    pub(crate) looking: PageGazeSource,
    size: [u32; 2],
    screen_size: [u32; 2],
    screen: Screen,
    pub(crate) coarse: bool,
    pub(crate) is_poster: bool,
    pub(crate) fetching: Fetching,
    pub(crate) levels_shown: bool,
    /// What the eyes of a headset asked for last, and when.
    eyes: [Option<EyeView>; 2],
    asked: f64,
}

impl PagePlayer {
    /// A session with an open pack; without a device the CPU twin draws.
    pub fn new(pack: &OpenPack, options: &Options, gpu: Option<Gpu>) -> Result<Self, String> {
        let pack = PackInParts::new(pack, &options.name, options.screen);
        let device = gpu.map_or(DrawDevice::Twin, DrawDevice::Gpu);
        let drawer = pack.drawer(&device);
        let navigation = pack.navigation(options);
        let detail = options.detail()?;
        let settings = SessionSettings {
            policy: detail.of(options.policy),
            bytes_per_s: Some(FIRST_GUESS),
            since: None,
            zooms: true,
            measures: pack.content.facts().is_measured,
            bounds: pack.bounds(),
        };
        let drawer = drawer.map_err(|error| error.to_string())?;
        let opened = pack.content.clone();
        let play = Player::new(opened, settings, drawer, Box::new(Outside), |_| ());
        refuse_policy(&play, play.session().policy())?;
        let viewer = ViewerSettings {
            plays: !options.paused,
            at_end: match options.once {
                true => AtEnd::StaysUntilPlayed,
                false => AtEnd::GoesRound,
            },
            holds_early: false,
        };
        Ok(Self {
            play,
            detail,
            log: options.log.then(String::new),
            log_is_full: false,
            bytes_per_s: FIRST_GUESS,
            viewer: Viewer::new(navigation, viewer),
            pack,
            looking: PageGazeSource::default(),
            size: options.size,
            screen_size: options.screen_size,
            screen: options.screen,
            coarse: options.coarse,
            is_poster: options.poster,
            fetching: Fetching::default(),
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
        self.viewer.play(self.play.session_mut(), now);
    }

    /// Stays at the frame that is on screen.
    pub fn pause(&mut self, now: Seconds) {
        self.viewer.pause(self.play.session(), now);
    }

    /// Goes on from another time of the content.
    pub fn seek(&mut self, to: Seconds, now: Seconds) {
        self.viewer.seek(self.play.session_mut(), to, now);
    }

    /// Pauses, and goes this many frames on or back.
    pub fn step_frames(&mut self, frames: i64, now: Seconds) {
        self.viewer
            .step_frames(self.play.session_mut(), frames, now);
    }

    /// Keeps to what is heard, a time of a round.
    pub fn heard(&mut self, heard: Seconds, now: Seconds) {
        self.viewer
            .hear(self.play.session(), Heard::InRound(heard), now);
    }

    /// Chooses by another policy; says why where that cannot be.
    pub fn set_policy(&mut self, policy: Policy) -> Result<(), String> {
        let config = self.detail.of(policy);
        refuse_policy(&self.play, &config)?;
        self.play
            .session_mut()
            .take(SessionEvent::PolicyChosen(Box::new(config)));
        Ok(())
    }

    /// The policy that needs fewer pixels for the target of the present one, by the content's
    /// calibration; `None` until that has been loaded, and where there is none.
    #[must_use]
    pub fn cheaper_policy(&self) -> Option<Policy> {
        let video = self.pack.content.video()?;
        let target = self.play.session().policy().target?;
        let density = density_of(&video.grid().surface, &self.shown().view);
        let (rule, _) = video.calibration()?.cheaper(target, Some(density))?;
        Some(Policy::judged_for(rule))
    }

    /// Chooses at another detail.
    pub fn set_detail(&mut self, detail: Detail) {
        self.detail = detail;
        let config = detail.of(self.play.session().policy().policy);
        if self.play.session().can(&config) {
            self.play
                .session_mut()
                .take(SessionEvent::PolicyChosen(Box::new(config)));
        }
    }

    /// Goes so many target scores on, or back; what is chosen for then, or nothing where the policy
    /// has no target.
    pub fn next_target(&mut self, by: i32) -> Option<Detail> {
        let PolicyConfig { policy, target, .. } = self.play.session().policy();
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
            self.play
                .session_mut()
                .take(SessionEvent::LinkRate { bytes_per_s });
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
        match self.play.drawer().device() {
            DrawDevice::Gpu(gpu) => gpu.adapter_name(),
            DrawDevice::Twin | DrawDevice::Nothing => "the processor",
        }
    }

    /// The graphics device, where one draws.
    pub(crate) fn gpu(&self) -> Option<Gpu> {
        match self.play.drawer().device() {
            DrawDevice::Gpu(gpu) => Some(gpu.clone()),
            DrawDevice::Twin | DrawDevice::Nothing => None,
        }
    }

    /// Starts over on another device.
    pub fn recover(&mut self, gpu: Gpu) -> Result<(), RenderError> {
        let drawer = self.pack.drawer(&DrawDevice::Gpu(gpu))?;
        self.play.recover(drawer);
        Ok(())
    }

    /// Takes what was decoded of a frame of a unit, for which so many frames were decoded; `None`
    /// where it is damaged.
    pub fn deliver(&mut self, unit: u32, frame: u32, frames: u32, decoded: Option<Payload>) {
        let unit = AssetId::ONLY.unit(UnitId(unit));
        self.play.take(Piece { unit, frame }, frames, decoded);
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
        self.viewer.is_moving(self.play.session())
    }

    /// Time of the content, within a round.
    pub fn time(&self, now: Seconds) -> Seconds {
        self.play.session().timeline().within(self.viewer.time(now))
    }

    /// Looks where the viewer looks and moves the session on; returns bits of [`flag`].
    pub fn step(&mut self, now: Seconds) -> Result<u32, PlayError> {
        let mut told = if self.viewer.stay_at_the_end(self.play.session(), now) {
            flag::ENDED
        } else {
            0
        };
        let pane = self.pane();
        self.viewer.navigation.fly_on(&pane, now);
        let moment = self.look(now, &pane);
        let step = self.viewer.now(self.play.session(), &moment, now);
        let Stepped {
            mut changed,
            wants,
            log,
            ..
        } = self.play.step(&step)?;
        self.write(&log);
        self.viewer.set_morphing(self.play.drawer().is_morphing());
        changed |= self.viewer.stepped(moment, &pane, self.levels_shown);
        if changed && self.play.session().shown_tick().is_some() {
            told |= flag::DRAW;
        }
        if wants {
            told |= flag::WANTS;
        }
        if self.play.session().is_hopeless() {
            told |= flag::HOPELESS;
        }
        if self.is_settled() {
            told |= flag::SETTLED;
        }
        if self.viewer.next_step(self.play.session(), now).is_some() || self.looking.moves() {
            told |= flag::AGAIN;
        }
        Ok(told)
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
        let perception = &self.play.session().policy().perception;
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
        self.viewer.is_settled(self.play.session())
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
        let is_entered = self.pack.content.facts().is_entered;
        let start = is_entered.then(|| self.shown().view.position);
        let view = request.view(start)?;
        let right = usize::from(request.eye == foveal_core::view::surface::Eye::Right);
        self.eyes[right] = Some(view);
        self.asked = now.0;
        Some(view)
    }

    /// What is to be shown was drawn in this many seconds.
    pub fn drawn(&mut self, seconds: f64) {
        self.viewer
            .drawn(self.play.session_mut(), Some(Seconds(seconds)));
    }
}

/// Says why a pack cannot be chosen by a policy.
fn refuse_policy(play: &Player, config: &PolicyConfig) -> Result<(), String> {
    if let Some(why) = play.opened().why_not(config.policy) {
        return Err(format!("policy {}: {why}", config.policy.name()));
    }
    match play.session().can(config) {
        true => Ok(()),
        false => Err("the pack has no tables for this policy; prepare it again".to_owned()),
    }
}
