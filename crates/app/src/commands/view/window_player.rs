//! How does a pack play in a window?
//!
//! Everything of a window but the window: time comes in as an argument, wishes as actions.

use crate::commands::view::draw_rate::DrawRate;
use crate::commands::view::gaze_source::{SaccadeKey, WindowGazeSource};
use crate::commands::view::log_file::LogFile;
use crate::commands::view::screen::overlay::OverlayPage;
use crate::commands::view::screen::words::{Page, Words};
use crate::commands::view::sound::Sound;
use crate::commands::view::sound::drift::Drift;
use crate::commands::view::styles::restyled;
use crate::commands::view::window::panes::{PanePart, RigPanes};
use crate::options::policy::PolicyOptions;
use crate::options::showing::EyeName;
use anyhow::bail;
use foveal_core::content::opened::ContentFacts;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::moment::Moment;
use foveal_core::perception::parameters::Parameters;
use foveal_core::session::actions::SessionEvent;
use foveal_core::session::figures::MOST_DRAW_S;
use foveal_core::session::viewer::{AtEnd, Heard, Viewer, ViewerSettings};
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::keys::Action;
use foveal_core::view::navigation::{Navigation, Pane, Shown};
use foveal_core::view::panel::rig::Panel;
use foveal_core::view::surface::Eye;
use foveal_play::{Player, Stepped};
use foveal_render::{Overlay, RenderError, TileStyle};
use std::time::Duration;

/// How long the sound waits for the frame that it begins with, in seconds.
const MOST_PREROLL_S: f64 = 1.0;
/// How often a gaze that moves by itself is looked at while nothing plays, in seconds.
const LOOK_S: f64 = 1.0 / 60.0;
/// No step is as late as this, in seconds.
const NEVER_S: f64 = 1e12;

/// What a window begins with.
pub(crate) struct Begin {
    pub(crate) policy: PolicyOptions,
    pub(crate) navigation: Navigation,
    pub(crate) log: Option<LogFile>,
    pub(crate) gaze_source: WindowGazeSource,
    pub(crate) sound: Option<Sound>,
    /// What may be spent in a second; `None` without a limit.
    pub(crate) bytes_per_s: Option<f64>,
    /// Stay at the end instead of starting over.
    pub(crate) once: bool,
    pub(crate) paused: bool,
    /// Whose picture is shown.
    pub(crate) eye: EyeName,
    /// Whether there is one for each eye.
    pub(crate) two_eyes: bool,
    /// The panels that show it, where there is a rig.
    pub(crate) panes: Option<RigPanes>,
}

/// A pack that plays in a window, with what is heard and said there.
pub(crate) struct WindowPlayer {
    pub(crate) live: Player,
    pub(crate) viewer: Viewer,
    pub(super) policy: PolicyOptions,
    pub(super) bytes_per_s: Option<f64>,
    log: Option<LogFile>,
    gaze_source: WindowGazeSource,
    pub(super) sound: Option<Sound>,
    /// Where the sound begins once the frame of that time is on screen, and since when it waits.
    preroll: Option<(Seconds, Seconds)>,
    words: Words,
    pub(super) draw_rate: DrawRate,
    levels: bool,
    borders: bool,
    /// Whether a scene is coloured by what the eye would gain of finer parts.
    importance: bool,
    /// Whether that was asked for otherwise since it was worked out.
    importance_is_stale: bool,
    saccade: SaccadeKey,
    /// How far picture and sound were from each other when frames were shown.
    pub(crate) drift: Drift,
    pub(super) eye: EyeName,
    pub(super) two_eyes: bool,
    panes: Option<RigPanes>,
}

/// What only a window can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WindowRequest {
    Nothing,
    FullScreen,
    Screenshot,
    Quit,
}

impl WindowPlayer {
    /// A pack that begins to play at `now`.
    pub(crate) fn new(live: Player, begin: Begin, now: Seconds) -> Self {
        let settings = ViewerSettings {
            plays: !begin.paused,
            at_end: match begin.once {
                true => AtEnd::Stays,
                false => AtEnd::GoesRound,
            },
            holds_early: true,
        };
        let mut player = Self {
            live,
            viewer: Viewer::new(begin.navigation, settings),
            policy: begin.policy,
            bytes_per_s: begin.bytes_per_s,
            log: begin.log,
            gaze_source: begin.gaze_source,
            sound: begin.sound,
            preroll: None,
            words: Words::default(),
            draw_rate: DrawRate::default(),
            levels: false,
            borders: false,
            importance: false,
            importance_is_stale: false,
            saccade: SaccadeKey::default(),
            drift: Drift::new(),
            eye: begin.eye,
            two_eyes: begin.two_eyes,
            panes: begin.panes,
        };
        if let Some(panes) = &player.panes {
            let panels = panes.mounted().to_vec();
            let session = player.live.session_mut();
            session.take(SessionEvent::Mounted(panels));
        }
        player.viewer.begin(now);
        if !begin.paused {
            player.set_sound(now);
        }
        player
    }

    /// Stops the sound; while it plays, it goes on from here once this frame is on screen.
    fn set_sound(&mut self, now: Seconds) {
        if let Some(sound) = &self.sound {
            let at = self.viewer.time(now);
            sound.set(false, at);
            self.preroll = self.viewer.is_playing().then_some((at, now));
        }
    }

    /// What follows from what is shown.
    pub(crate) fn facts(&self) -> &'static ContentFacts {
        self.live.opened().facts()
    }

    /// Does what was asked for, or says what the window must do.
    pub(crate) fn act(&mut self, action: Action, pane: &Pane, now: Seconds) -> WindowRequest {
        if let Some(why) = senseless_in_scenes(action).filter(|_| self.facts().is_entered) {
            self.say(why.to_owned(), now);
            return WindowRequest::Nothing;
        }
        let navigation = &mut self.viewer.navigation;
        match action {
            Action::Pause | Action::Skip(_) | Action::Step(_) | Action::First | Action::Last => {
                self.go(action, now);
            }
            Action::Move([x, y]) => {
                let width = f64::from(pane.size[0]);
                navigation.drag([x * width, y * width], pane);
            }
            Action::Zoom(factor) => {
                let middle = pane.size.map(|side| f64::from(side) / 2.0);
                navigation.zoom_by(factor, middle, pane);
            }
            Action::Reset => navigation.reset(),
            Action::Fly(towards) => navigation.step(towards, pane),
            Action::Policy(by) => self.next_policy(by, now),
            Action::Target(by) => self.next_target(by, now),
            Action::Blur | Action::Interpolation | Action::Textures => {
                self.restyle(action, now);
            }
            Action::Eye => self.next_eye(now),
            Action::Levels => {
                self.levels = !self.levels;
                self.show_importance(false);
            }
            Action::Importance => self.toggle_importance(now),
            // Held, it is no deed by itself.
            Action::Saccade => {}
            Action::Borders => self.borders = !self.borders,
            Action::Sound => self.toggle_sound(now),
            Action::Overlay => self.words.turn_the_page(),
            Action::Figures => self.words.toggle_figures(),
            Action::Screenshot => return WindowRequest::Screenshot,
            Action::FullScreen => return WindowRequest::FullScreen,
            Action::Quit => return WindowRequest::Quit,
        }
        WindowRequest::Nothing
    }

    /// Plays, pauses or goes elsewhere in time; the sound comes along.
    fn go(&mut self, action: Action, now: Seconds) {
        let (viewer, session) = (&mut self.viewer, self.live.session_mut());
        match action {
            Action::Skip(seconds) => viewer.skip(session, seconds, now),
            Action::Step(frames) => viewer.step_frames(session, frames, now),
            Action::First => viewer.seek_first(session, now),
            Action::Last => viewer.seek_last(session, now),
            _ if viewer.is_playing() => viewer.pause(session, now),
            _ => viewer.play(session, now),
        }
        self.set_sound(now);
    }

    /// Shows tiles in another way.
    fn restyle(&mut self, action: Action, now: Seconds) {
        let (style, said) = restyled(self.live.style(), action);
        self.take_style(style, said.to_owned(), now);
    }

    pub(super) fn take_style(&mut self, style: TileStyle, said: String, now: Seconds) {
        let tiles = self.live.drawer_mut().tiles_mut();
        match tiles.map_or(Ok(false), |tiles| tiles.restyle(style)) {
            Ok(true) => self.live.session_mut().fetch_anew(),
            Ok(false) => {}
            Err(error) => return self.say(error.to_string(), now),
        }
        self.say(said, now);
    }

    fn show_importance(&mut self, shows: bool) {
        self.importance_is_stale = shows != self.importance;
        self.importance = shows;
    }

    fn toggle_importance(&mut self, now: Seconds) {
        self.show_importance(!self.importance);
        self.levels = false;
        let said = match self.importance {
            true => "red: finer parts are worth most to the eye; blue: least",
            false => "colours as they are",
        };
        self.say(said.to_owned(), now);
    }

    /// Works out what units are worth to an eye with these parameters, where that is shown. A
    /// device that is lost meanwhile is opened again, and all is worked out again.
    fn mark_worth(&mut self, perception: &Parameters, now: Seconds) {
        let viewer = self.viewer.moment().filter(|_| self.importance);
        let viewer = viewer.map(|moment| (perception, moment));
        let scene = self.live.drawer_mut().scene_mut();
        let marked = scene.map_or(Ok(()), |scene| scene.mark_worth(viewer));
        self.importance_is_stale = matches!(marked, Err(RenderError::ReadBack(_)));
        if let Err(error) = marked.map_err(|error| error.to_string())
            && !self.importance_is_stale
        {
            self.importance = false;
            self.say(error, now);
        }
    }

    /// The key is held that stands for a saccade, or let go.
    pub(crate) fn hold_saccade(&mut self, is_held: bool, now: Seconds) {
        self.saccade.hold(is_held, now);
    }

    fn next_eye(&mut self, now: Seconds) {
        if self.two_eyes {
            self.eye = self.eye.next();
            self.say(format!("eye {}", self.eye.name()), now);
        } else {
            self.say("there is one picture for both eyes".to_owned(), now);
        }
    }

    /// The eyes whose pictures lie side by side in the window.
    pub(crate) fn eyes(&self) -> &'static [Eye] {
        match self.eye {
            EyeName::Both if !self.two_eyes => &[Eye::Left],
            eye => eye.eyes(),
        }
    }

    fn toggle_sound(&mut self, now: Seconds) {
        let said = match &self.sound {
            Some(sound) if sound.toggle() => "sound on",
            Some(_) => "sound off",
            None => "there is no sound",
        };
        self.say(said.to_owned(), now);
    }

    /// Shows a message for some seconds.
    pub(crate) fn say(&mut self, message: String, now: Seconds) {
        self.words.say(message, now);
    }

    /// Looks where the viewer looks and moves the session on. Returns whether to repaint.
    pub(crate) fn step(&mut self, pane: &Pane, now: Seconds) -> anyhow::Result<bool> {
        self.viewer.navigation.fly_on(pane, now);
        self.follow_sound(now);
        if self.viewer.stay_at_the_end(self.live.session(), now) {
            self.set_sound(now);
        }
        let moment = self.moment(pane, now);
        let config = self.live.session().policy_in_use().clone();
        let view = self.viewer.shown(pane).view;
        let tiles = self.live.drawer_mut().tiles_mut();
        if tiles.map_or(Ok(false), |tiles| tiles.prepare(&config, &view))? {
            self.live.session_mut().fetch_anew();
        }
        let step = self.viewer.now(self.live.session(), &moment, now);
        let Stepped {
            mut changed, log, ..
        } = self.live.step(&step)?;
        self.viewer.set_morphing(self.live.drawer().is_morphing());
        if let Some(file) = self.log.as_mut().filter(|_| !log.is_empty()) {
            file.write(&log)?;
        }
        if self.live.session().is_hopeless() {
            bail!(
                "{}: no frame has a whole coarsest level; `foveal verify` lists all damage",
                self.live.opened().content().name()
            );
        }
        let style = self.live.style();
        let marks_gaze = self.levels && self.facts().has_tiles || self.importance;
        let drawn_by_gaze = marks_gaze || style.samples || style.blurs;
        changed |= self.viewer.stepped(moment, pane, drawn_by_gaze);
        if changed || self.importance_is_stale {
            self.mark_worth(&config.perception, now);
            changed = true;
        }
        Ok(changed || self.words.are_stale(now, self.is_moving()))
    }

    /// Whether the content moves.
    pub(super) fn is_moving(&self) -> bool {
        self.viewer.is_moving(self.live.session())
    }

    /// Whether a frame that was not on screen before waits for its time once it is drawn.
    pub(crate) fn holds_back(&self) -> bool {
        self.viewer.holds_back(self.live.session())
    }

    /// How long that wait is at `now`.
    pub(crate) fn early_by(&self, now: Seconds) -> Duration {
        Duration::from_secs_f64(self.viewer.early_by(self.live.session(), now).0)
    }

    fn follow_sound(&mut self, now: Seconds) {
        if self.sound.as_ref().is_some_and(Sound::waits) {
            self.set_sound(now);
        }
        let heard = self.heard(now);
        self.viewer.hear(self.live.session(), heard, now);
    }

    /// What the sound says about the content's time; one that waits for its frame begins with it.
    fn heard(&mut self, now: Seconds) -> Heard {
        let Some(sound) = &self.sound else {
            return Heard::Nothing;
        };
        let session = self.live.session();
        if let Some((at, since)) = self.preroll {
            // One that is ahead was chosen for when it would have been drawn.
            let [first, last] =
                [0.0, MOST_DRAW_S].map(|s| session.timeline().tick_at(Seconds(at.0 + s)));
            let drawn = self.viewer.drawn_tick();
            let is_there = drawn.is_some_and(|tick| (first..=last).contains(&tick));
            if is_there || now.0 - since.0 > MOST_PREROLL_S {
                self.preroll = None;
                sound.set(true, at);
            }
            return Heard::Begins(at, None);
        }
        if !self.viewer.is_moving(session) {
            return Heard::Nothing;
        }
        match (sound.begins(), sound.heard()) {
            (Some((at, within)), _) => Heard::Begins(at, within),
            (None, Some(heard)) => Heard::At(heard),
            (None, None) => Heard::Nothing,
        }
    }

    /// What selection is given, with the head turned to where it points.
    fn moment(&mut self, pane: &Pane, now: Seconds) -> Moment {
        let perception = &self.live.session().policy_in_use().perception;
        let (viewer, panes) = (&mut self.viewer, self.panes.as_ref());
        let moment = self
            .gaze_source
            .moment(now, viewer, (pane, panes), perception);
        Moment {
            behind_sound: self.drift.last(),
            state: self.saccade.state(now, perception).unwrap_or(moment.state),
            ..moment
        }
    }

    /// What is to be shown was drawn at this time; `begun` is when it was chosen, if it was not
    /// there before.
    pub(crate) fn drawn(&mut self, begun: Option<Seconds>, at: Seconds) {
        self.draw_rate.note(at);
        // What is drawn again while another frame is awaited shows nothing.
        if self.viewer.is_drawn(self.live.session()) {
            return;
        }
        let took = begun.map(|begun| Seconds(at.0 - begun.0));
        self.viewer.drawn(self.live.session_mut(), took);
        let session = self.live.session();
        let heard = self.sound.as_ref().and_then(Sound::heard);
        let behind = heard.zip(session.shown_tick()).map(|(heard, tick)| {
            let span = [tick, tick + 1].map(|tick| session.timeline().time_of(tick));
            Drift::of_frame(heard, span)
        });
        self.drift.note(behind, self.is_moving());
    }

    /// Whether nothing on screen is going to change by itself, or it plays.
    pub(crate) fn is_settled(&self) -> bool {
        self.viewer.is_settled(self.live.session())
    }

    /// When to step again though nothing happens, by the window's clock.
    pub(crate) fn next_step(&self, now: Seconds) -> Option<Seconds> {
        let changes = self.viewer.next_step(self.live.session(), now);
        let looks = self.gaze_source.moves().then_some(now.0 + LOOK_S);
        let times = changes.map(|at| at.0).into_iter().chain(looks);
        let times = times.chain(self.words.due(now, self.is_moving()));
        let perception = &self.live.session().policy_in_use().perception;
        let lands = self.saccade.landed(perception);
        let times = times.chain(lands.map(|at| at.0).filter(|at| *at > now.0));
        let next = times.filter(|time| *time < NEVER_S).reduce(f64::min);
        next.map(Seconds)
    }

    /// What the window shows.
    pub(crate) fn shown(&self, pane: &Pane) -> Shown {
        self.viewer.shown(pane)
    }

    /// What the last step was made for.
    pub(crate) fn gaze(&self) -> Option<GazeSample> {
        self.viewer.moment().map(|moment| moment.gaze)
    }

    /// What is drawn where in the window: the picture of each eye, or of each panel.
    pub(crate) fn parts(&self, pane: &Pane) -> Vec<PanePart> {
        let shown = self.shown(pane);
        if let Some(panes) = &self.panes {
            let head = self.viewer.navigation.head();
            return panes.parts(pane.size, head, shown.view.position);
        }
        let [left, top] = shown.origin;
        let parts = (0..).zip(self.eyes()).map(|(part, eye)| PanePart {
            view: EyeView {
                eye: *eye,
                ..shown.view
            },
            origin: [left + part * pane.size[0], top],
            size: shown.view.size,
            flips: [false; 2],
        });
        parts.collect()
    }

    /// The panels that show it, with the pixels that the window has for them.
    pub(crate) fn panels_in(&self, pane: &Pane) -> Vec<Panel> {
        let panes = self.panes.as_ref();
        panes.map_or_else(Vec::new, |panes| panes.panels_in(pane.size))
    }

    /// Whether panels show it.
    pub(crate) fn has_panels(&self) -> bool {
        self.panes.is_some()
    }

    /// What is drawn over the picture of a view.
    pub(crate) fn marks(&self, view: &EyeView) -> Option<Overlay> {
        let fovea = self.viewer.fovea_in(view)?;
        let style = self.live.style();
        let marks = self.levels || self.borders;
        if !marks || style.samples || style.has_textures {
            return None;
        }
        let plain = Overlay::default();
        Some(Overlay {
            gaze: fovea.place.map(|place| place as f32),
            gaze_radius: if self.levels {
                fovea.radius as f32
            } else {
                0.0
            },
            heat: if self.levels { plain.heat } else { 0.0 },
            borders: if self.borders { 0.5 } else { 0.0 },
            ..plain
        })
    }

    /// What is written over the picture: the page of the overlay that is open, and a message.
    pub(crate) fn words(&mut self, now: Seconds) -> (Option<OverlayPage>, Option<String>) {
        let (page, message) = self.words.paint(now);
        let told = match page {
            Page::Nothing => None,
            Page::Keys => Some(OverlayPage::Keys(self.keys())),
            Page::Figures => Some(OverlayPage::Figures(self.lines(now))),
        };
        (told, message)
    }

    /// Times that the sound device found too little to play.
    pub(crate) fn sound_gaps(&self) -> u64 {
        self.sound.as_ref().map_or(0, Sound::gaps)
    }
}

/// Why a scene does not do what a key does over video; `None` of what it does.
fn senseless_in_scenes(action: Action) -> Option<&'static str> {
    match action {
        Action::Pause | Action::Skip(_) | Action::Step(_) | Action::First | Action::Last => {
            Some("a scene has no time")
        }
        Action::Blur | Action::Interpolation | Action::Textures | Action::Borders => {
            Some("a scene has no tiles: that is for video")
        }
        _ => None,
    }
}
