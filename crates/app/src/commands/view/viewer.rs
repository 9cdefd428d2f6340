//! What does a viewer's session do at each moment?
//!
//! Everything of a window but the window: time comes in as an argument, wishes as actions.

use crate::commands::view::log_file::LogFile;
use crate::commands::view::looking::{Looking, Watched};
use crate::commands::view::screen::overlay::Told;
use crate::commands::view::screen::words::{Page, Words};
use crate::commands::view::sound::Sound;
use crate::commands::view::sound::drift::Drift;
use crate::commands::view::telling;
use crate::options::policy::PolicyOptions;
use crate::options::showing::EyeName;
use anyhow::bail;
use foveal_core::gaze::pointer::Pointer;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::session::actions::{Now, Pace};
use foveal_core::session::aim::Aim;
use foveal_core::session::figures::MOST_DRAW_S;
use foveal_core::session::media_clock::MediaClock;
use foveal_core::units::Seconds;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::keys::Action;
use foveal_core::view::navigation::{Navigation, Pane, Shown};
use foveal_core::view::surface::Eye;
use foveal_play::{LivePlayer, Stepped};
use foveal_render::{Interpolation, Overlay, TileStyle};
use std::time::Duration;

/// Radius of the ring round the gaze, in degrees: the fovea.
const FOVEA_DEG: f64 = 2.5;
/// How long the sound waits for the frame that it begins with, in seconds.
const MOST_PREROLL_S: f64 = 1.0;
/// How often a gaze that moves by itself is looked at while nothing plays, in seconds.
const LOOK_S: f64 = 1.0 / 60.0;

/// What a viewer begins with.
pub(crate) struct Begin {
    pub(crate) policy: PolicyOptions,
    pub(crate) scene: Navigation,
    pub(crate) log: Option<LogFile>,
    pub(crate) looking: Looking,
    pub(crate) sound: Option<Sound>,
    /// Stay at the end instead of beginning anew.
    pub(crate) once: bool,
    pub(crate) paused: bool,
    /// Whose picture is shown.
    pub(crate) eye: EyeName,
    /// Whether there is one for each eye.
    pub(crate) two_eyes: bool,
}

/// A viewer's session.
pub(crate) struct Viewer {
    pub(super) policy: PolicyOptions,
    pub(crate) scene: Navigation,
    pub(super) clock: MediaClock,
    log: Option<LogFile>,
    looking: Looking,
    pub(crate) pointer: Pointer,
    pub(super) sound: Option<Sound>,
    /// Where the sound begins once the frame of that time is on screen, and since when it waits.
    preroll: Option<(Seconds, Seconds)>,
    /// While the picture waits for sound: how long until it is heard, infinite where nobody knows.
    sound_in: Option<f64>,
    once: bool,
    words: Words,
    levels: bool,
    borders: bool,
    /// What the last step was made for.
    last: Option<(Aim, Shown)>,
    /// How far picture and sound were from each other when frames were shown.
    pub(crate) drift: Drift,
    /// What was drawn last.
    drawn_tick: Option<u64>,
    pub(super) eye: EyeName,
    pub(super) two_eyes: bool,
}

/// What only a window can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wish {
    Nothing,
    FullScreen,
    Screenshot,
    Quit,
}

impl Viewer {
    /// A session that begins at `now`.
    pub(crate) fn new(begin: Begin, now: Seconds) -> Self {
        let mut viewer = Self {
            policy: begin.policy,
            scene: begin.scene,
            clock: MediaClock::default(),
            log: begin.log,
            looking: begin.looking,
            pointer: Pointer::default(),
            sound: begin.sound,
            preroll: None,
            sound_in: None,
            once: begin.once,
            words: Words::default(),
            levels: false,
            borders: false,
            last: None,
            drift: Drift::new(),
            drawn_tick: None,
            eye: begin.eye,
            two_eyes: begin.two_eyes,
        };
        if !begin.paused {
            viewer.play(now);
        }
        viewer
    }

    fn play(&mut self, now: Seconds) {
        self.clock.play(now);
        self.set_sound(now);
    }

    /// Stops the sound; while it plays, it goes on from here once this frame is on screen.
    fn set_sound(&mut self, now: Seconds) {
        if let Some(sound) = &self.sound {
            let at = self.clock.time(now);
            sound.set(false, at);
            self.preroll = self.clock.is_playing().then_some((at, now));
        }
    }

    /// Does what was asked for, or says what the window must do.
    pub(crate) fn act(
        &mut self,
        action: Action,
        stage: &mut LivePlayer,
        pane: &Pane,
        now: Seconds,
    ) -> Wish {
        match action {
            Action::Pause if self.clock.is_playing() => self.pause(stage, now),
            Action::Pause => self.play(now),
            Action::Skip(seconds) => self.skip(stage, seconds, now),
            Action::Step(frames) => self.step_frames(stage, frames, now),
            Action::First => self.seek_in_round(stage, 0, now),
            Action::Last => self.seek_in_round(stage, stage.session().timeline().frames() - 1, now),
            Action::Move([x, y]) => {
                let width = f64::from(pane.size[0]);
                self.scene.drag([x * width, y * width], pane);
            }
            Action::Zoom(factor) => {
                let middle = pane.size.map(|side| f64::from(side) / 2.0);
                self.scene.zoom_by(factor, middle, pane);
            }
            Action::Reset => self.scene.reset(),
            Action::Policy(by) => self.next_policy(by, stage, now),
            Action::Target(by) => self.next_target(by, stage, now),
            Action::Blur | Action::Interpolation | Action::Textures => {
                self.restyle(action, stage, now);
            }
            Action::Eye => self.next_eye(now),
            Action::Levels => self.levels = !self.levels,
            Action::Borders => self.borders = !self.borders,
            Action::Sound => self.toggle_sound(now),
            Action::Overlay => self.words.turn_the_page(),
            Action::Figures => self.words.toggle_figures(),
            Action::Screenshot => return Wish::Screenshot,
            Action::FullScreen => return Wish::FullScreen,
            Action::Quit => return Wish::Quit,
        }
        Wish::Nothing
    }

    /// Stays at the frame that is on screen.
    fn pause(&mut self, stage: &LivePlayer, now: Seconds) {
        let timeline = stage.session().timeline();
        let due = timeline.tick_at(self.clock.time(now));
        let tick = stage.session().shown_tick().unwrap_or(due);
        self.clock.pause(timeline.time_of(tick));
        self.set_sound(now);
    }

    fn seek(&mut self, stage: &mut LivePlayer, to: Seconds, now: Seconds) {
        self.clock.seek(to, now);
        self.set_sound(now);
        stage.session_mut().jump();
    }

    /// Forward or back, not beyond the ends of the round that is under way.
    fn skip(&mut self, stage: &mut LivePlayer, seconds: f64, now: Seconds) {
        let timeline = stage.session().timeline();
        let at = self.clock.time(now);
        let begin = timeline.tick_at(at) / timeline.frames() * timeline.frames();
        let [first, last] = [begin, begin + timeline.frames() - 1].map(|t| timeline.time_of(t).0);
        self.seek(stage, Seconds((at.0 + seconds).clamp(first, last)), now);
    }

    fn seek_in_round(&mut self, stage: &mut LivePlayer, frame: u64, now: Seconds) {
        let timeline = stage.session().timeline();
        let tick = timeline.tick_at(self.clock.time(now));
        let begin = tick - tick % timeline.frames();
        let to = timeline.time_of(begin + frame);
        self.seek(stage, to, now);
    }

    fn step_frames(&mut self, stage: &mut LivePlayer, frames: i64, now: Seconds) {
        if self.clock.is_playing() {
            self.pause(stage, now);
        }
        let timeline = stage.session().timeline();
        let tick = timeline.tick_at(self.clock.time(now));
        // Before the first frame comes the last.
        let around = if frames < 0 && tick < frames.unsigned_abs() {
            timeline.frames()
        } else {
            0
        };
        let to = timeline.time_of((tick + around).saturating_add_signed(frames));
        self.seek(stage, to, now);
    }

    /// Shows tiles in another way.
    fn restyle(&mut self, action: Action, stage: &mut LivePlayer, now: Seconds) {
        let mut style = stage.style();
        let said = match action {
            Action::Interpolation if !style.samples => {
                "policy sampled has pixels to fill between samples, this one has not"
            }
            Action::Textures if style.samples => "policy sampled shows no tiles",
            Action::Interpolation => {
                style.interpolation = match style.interpolation {
                    Interpolation::Nearest => Interpolation::Blended,
                    Interpolation::Blended => Interpolation::Nearest,
                };
                telling::interpolation(style.interpolation)
            }
            Action::Textures => {
                style.has_textures = !style.has_textures;
                telling::reconstruction(style)
            }
            _ => {
                style.blurs = !style.blurs;
                if style.blurs { "blur on" } else { "blur off" }
            }
        };
        self.take_style(style, stage, said.to_owned(), now);
    }

    pub(super) fn take_style(
        &mut self,
        style: TileStyle,
        stage: &mut LivePlayer,
        said: String,
        now: Seconds,
    ) {
        match stage.drawer().restyle(style) {
            Ok(true) => stage.session_mut().fetch_anew(),
            Ok(false) => {}
            Err(error) => return self.say(error.to_string(), now),
        }
        self.say(said, now);
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

    /// Looks where the viewer looks and moves the stage on. Returns whether to paint anew.
    pub(crate) fn step(
        &mut self,
        stage: &mut LivePlayer,
        pane: &Pane,
        now: Seconds,
    ) -> anyhow::Result<bool> {
        self.follow_sound(stage, now);
        self.stay_at_the_end(stage, now);
        let aim = self.aim(stage, pane, now);
        let config = stage.session().policy_in_use().clone();
        if stage.drawer().prepare(&config, &aim.view)? {
            stage.session_mut().fetch_anew();
        }
        let step = Now {
            wall: now,
            media: self.due(stage, now),
            pace: match self.is_moving(stage) {
                true => Pace::Playing,
                false => Pace::Standing,
            },
            drawing: self.slow_draw(stage),
            until: aim.gaze.time,
            aim,
        };
        let Stepped { mut changed, log } = stage.step(&step)?;
        if let Some(file) = self.log.as_mut().filter(|_| !log.is_empty()) {
            file.write(&log)?;
        }
        if stage.session().is_hopeless() {
            bail!(
                "{}: no frame has a whole coarsest level; `foveal verify` lists all damage",
                stage.path().display()
            );
        }
        let shown = self.scene.shown(pane);
        if let Some((before, shown_before)) = &self.last {
            let style = stage.style();
            let follows = self.levels || style.samples || style.blurs;
            let moved = before.gaze.gaze_in_content != aim.gaze.gaze_in_content;
            changed |= *shown_before != shown || follows && moved;
        }
        self.last = Some((aim, shown));
        Ok(changed || self.words.are_stale(now, self.is_moving(stage)))
    }

    /// Whether the content moves.
    pub(super) fn is_moving(&self, stage: &LivePlayer) -> bool {
        self.clock.is_playing() && !stage.session().timeline().is_still()
    }

    /// The moment of the content to show: the one that it is when it has been drawn.
    fn due(&self, stage: &LivePlayer, now: Seconds) -> Seconds {
        let slow = self.slow_draw(stage).0;
        let drawing = if slow > 0.0 {
            // Most pictures are drawn by then, and wait.
            slow
        } else if self.is_moving(stage) {
            stage.session().figures.draw_s
        } else {
            0.0
        };
        let waits = self.sound_in.unwrap_or(0.0);
        Seconds(self.clock.time(now).0 + (drawing - waits).max(0.0))
    }

    /// How long pictures are drawn where some frames are left out because of it, and else 0.
    fn slow_draw(&self, stage: &LivePlayer) -> Seconds {
        let moving = self.is_moving(stage);
        let slow = moving.then(|| stage.session().figures.slow_draw(stage.session().period()));
        slow.unwrap_or_default()
    }

    /// Whether a frame that was not on screen before waits for its time once it is drawn.
    pub(crate) fn waits(&self, stage: &LivePlayer) -> bool {
        self.slow_draw(stage).0 > 0.0 && stage.session().shown_tick() != self.drawn_tick
    }

    /// How long it is at `now` until the time of what is to be shown: it was chosen for a drawing
    /// as long as the longest of late, and is not earlier than that.
    pub(crate) fn early_by(&self, stage: &LivePlayer, now: Seconds) -> Duration {
        let begin = stage
            .session()
            .shown_tick()
            .map(|tick| stage.session().timeline().time_of(tick));
        let early = begin.map_or(0.0, |begin| begin.0 - self.clock.time(now).0);
        let waits = self.sound_in.filter(|_| early > 0.0).unwrap_or(0.0);
        let early = early + waits;
        Duration::from_secs_f64(early.clamp(0.0, self.slow_draw(stage).0))
    }

    fn follow_sound(&mut self, stage: &LivePlayer, now: Seconds) {
        if self.sound.as_ref().is_some_and(Sound::waits) {
            self.set_sound(now);
        }
        let waited = self.sound_in.take().is_some();
        let Some(sound) = &self.sound else {
            return;
        };
        if let Some((at, since)) = self.preroll {
            self.clock.seek(at, now);
            self.sound_in = Some(f64::INFINITY);
            // One that is ahead was chosen for when it would have been drawn.
            let [first, last] =
                [0.0, MOST_DRAW_S].map(|s| stage.session().timeline().tick_at(Seconds(at.0 + s)));
            let is_there = self.drawn_tick.is_some_and(|t| (first..=last).contains(&t));
            if is_there || now.0 - since.0 > MOST_PREROLL_S {
                self.preroll = None;
                sound.set(true, at);
            }
        } else if !self.is_moving(stage) {
            // A picture that stands is in step with anything.
        } else if let Some((begin, until)) = sound.begins() {
            self.clock.seek(begin, now);
            self.sound_in = Some(until.map_or(f64::INFINITY, |until| until.0));
        } else if let Some(heard) = sound.heard() {
            match waited {
                true => self.clock.seek(heard, now),
                false => self.clock.follow(heard, now),
            }
        }
    }

    fn stay_at_the_end(&mut self, stage: &LivePlayer, now: Seconds) {
        let timeline = stage.session().timeline();
        let last = timeline.frames() - 1;
        let over = self.clock.time(now).0 >= timeline.length().0;
        if self.once && over && self.clock.is_playing() {
            self.clock.pause(timeline.time_of(last));
            self.set_sound(now);
        }
    }

    /// What selection is given, with the head turned to where it points.
    fn aim(&mut self, stage: &LivePlayer, pane: &Pane, now: Seconds) -> Aim {
        let watched = Watched {
            now,
            pointer: &self.pointer,
            perception: &stage.session().policy_in_use().perception,
        };
        let scene = &mut self.scene;
        let aim = self.looking.aim(&watched, |head| {
            if let Some(head) = head {
                scene.look_along(head);
            }
            scene.shown(pane)
        });
        Aim {
            gaze: GazeSample {
                gaze_in_content: self.scene.with_the_hand(aim.gaze.gaze_in_content),
                ..aim.gaze
            },
            head: self.scene.head(),
            behind_sound: self.drift.last(),
            ..aim
        }
    }

    /// What is to be shown was drawn and then on screen at these times; `begun` is when it was
    /// chosen, if it was not there before.
    pub(crate) fn drawn(
        &mut self,
        stage: &mut LivePlayer,
        begun: Option<Seconds>,
        at: [Seconds; 2],
    ) {
        // What is drawn again while another frame is awaited tells nothing.
        if self.drawn_tick == stage.session().shown_tick() {
            return;
        }
        self.drawn_tick = stage.session().shown_tick();
        if let Some(begun) = begun.filter(|_| self.is_moving(stage)) {
            let period = stage.session().period();
            let figures = &mut stage.session_mut().figures;
            figures.drawn(at[0].0 - begun.0, period);
        }
        let heard = self.sound.as_ref().and_then(Sound::heard);
        let behind = heard
            .zip(stage.session().shown_tick())
            .map(|(heard, tick)| {
                let span = [tick, tick + 1].map(|tick| stage.session().timeline().time_of(tick));
                Drift::of_frame(heard, span)
            });
        self.drift.note(behind, self.is_moving(stage));
    }

    /// Whether nothing on screen is going to change by itself, or it plays.
    pub(crate) fn is_settled(&self, stage: &LivePlayer) -> bool {
        let behind = |(aim, _): &(Aim, Shown)| stage.session().is_behind(aim);
        if self.is_moving(stage) {
            return stage.session().shown_tick().is_some();
        }
        stage.session().is_settled() && !self.last.as_ref().is_none_or(behind)
    }

    /// When to step again though nothing happens, by the window's clock.
    pub(crate) fn next_step(&self, stage: &LivePlayer, now: Seconds) -> Option<Seconds> {
        let mut times = Vec::new();
        if self.is_moving(stage) {
            let media = self.due(stage, now).0;
            let due = stage.session().next_due().map_or(media, |due| due.0);
            // What is overdue comes with the tiles that are waited for.
            times.push(now.0 + if due > media { due - media } else { 0.02 });
        } else if !self.is_settled(stage) {
            times.push(now.0 + 0.03);
        }
        if self.looking.moves() {
            times.push(now.0 + LOOK_S);
        }
        times.extend(
            self.pointer
                .forgotten()
                .map(|at| at.0)
                .filter(|at| *at > now.0),
        );
        times.extend(self.words.due(now, self.is_moving(stage)));
        let next = times
            .into_iter()
            .filter(|time| *time < 1e12)
            .reduce(f64::min);
        next.map(Seconds)
    }

    /// What the window shows.
    pub(crate) fn shown(&self, pane: &Pane) -> Shown {
        self.scene.shown(pane)
    }

    /// What the last step was made for, in an eye's view.
    pub(crate) fn aim_in(&self, view: &EyeView) -> Option<Aim> {
        let (aim, _) = self.last?;
        Some(Aim { view: *view, ..aim })
    }

    /// What is drawn over the picture.
    pub(crate) fn marks(&self, stage: &LivePlayer) -> Option<Overlay> {
        let (aim, shown) = self.last.as_ref()?;
        let style = stage.style();
        let marks = self.levels || self.borders;
        if !marks || style.samples || style.has_textures {
            return None;
        }
        let direction = aim.gaze.gaze_in_content;
        let place = shown.view.place(direction).unwrap_or([-1e6; 2]);
        let seen = shown.view.seen_direction(direction).unwrap_or(direction);
        let ppd = shown.view.as_seen().ppd_towards(seen).0;
        let plain = Overlay::default();
        Some(Overlay {
            gaze: place.map(|place| place as f32),
            gaze_radius: if self.levels {
                (ppd * FOVEA_DEG) as f32
            } else {
                0.0
            },
            heat: if self.levels { plain.heat } else { 0.0 },
            borders: if self.borders { 0.5 } else { 0.0 },
            ..plain
        })
    }

    /// What is written over the picture: the page of the overlay that is open, and a message.
    pub(crate) fn words(
        &mut self,
        stage: &LivePlayer,
        now: Seconds,
    ) -> (Option<Told>, Option<String>) {
        let (page, message) = self.words.paint(now);
        let told = match page {
            Page::Nothing => None,
            Page::Keys => Some(Told::Keys(self.keys(stage))),
            Page::Figures => Some(Told::Figures(self.lines(stage, now))),
        };
        (told, message)
    }

    /// Times that the sound device found too little to play.
    pub(crate) fn sound_gaps(&self) -> u64 {
        self.sound.as_ref().map_or(0, Sound::gaps)
    }
}
