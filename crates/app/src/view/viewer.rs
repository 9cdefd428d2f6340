//! What does a viewer's session do at each moment?
//!
//! Everything of a window but the window: time comes in as an argument, wishes as actions.

use super::choice::{Aim, Choice};
use super::clock::MediaClock;
use super::figures::Figures;
use super::keys::Action;
use super::looking::{Looking, Pointer, Watched};
use super::overlay::Line;
use super::scene::{Pane, Scene, Shown};
use super::sound::Sound;
use super::stage::{Now, Stage};
use crate::options::PolicyOptions;
use foveal_core::selection::policy::Policy;
use foveal_core::units::Seconds;
use foveal_render::Overlay;

/// The policies that a key goes through.
const POLICIES: [Policy; 8] = [
    Policy::Viewport,
    Policy::Acuity,
    Policy::Perceptual,
    Policy::Eccentricity,
    Policy::Uniform,
    Policy::Grid,
    Policy::Full,
    Policy::Coarsest,
];
/// Radius of the ring round the gaze, in degrees: the fovea.
const FOVEA_DEG: f64 = 2.5;
/// How long a message stays, in seconds.
const MESSAGE_S: f64 = 3.0;
/// How long sound and picture may take to come together after a beginning or a jump, in seconds.
const SOUND_BEGINS_S: f64 = 2.0;
/// How often figures are painted anew, in seconds.
const FIGURES_S: f64 = 0.25;
/// How often a gaze that moves by itself is looked at while nothing plays, in seconds.
const LOOK_S: f64 = 1.0 / 60.0;

/// What a viewer begins with.
pub(crate) struct Begin {
    pub(crate) policy: PolicyOptions,
    pub(crate) scene: Scene,
    pub(crate) choice: Choice,
    pub(crate) looking: Looking,
    pub(crate) sound: Option<Sound>,
    /// Stay at the end instead of beginning anew.
    pub(crate) once: bool,
    pub(crate) paused: bool,
}

/// A viewer's session.
pub(crate) struct Viewer {
    policy: PolicyOptions,
    pub(crate) scene: Scene,
    clock: MediaClock,
    choice: Choice,
    looking: Looking,
    pub(crate) pointer: Pointer,
    sound: Option<Sound>,
    once: bool,
    pub(crate) figures: Figures,
    overlay: bool,
    heat_map: bool,
    borders: bool,
    message: Option<(String, f64)>,
    /// What the last step was made for.
    last: Option<(Aim, Shown)>,
    painted: f64,
    /// Greatest distance of picture and sound so far, once both had begun.
    worst_sound: f64,
    /// When the sound was last told where to begin.
    sound_set: f64,
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
            clock: MediaClock::new(),
            choice: begin.choice,
            looking: begin.looking,
            pointer: Pointer::default(),
            sound: begin.sound,
            once: begin.once,
            figures: Figures::default(),
            overlay: false,
            heat_map: false,
            borders: false,
            message: None,
            last: None,
            painted: 0.0,
            worst_sound: 0.0,
            sound_set: 0.0,
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

    fn set_sound(&mut self, now: Seconds) {
        self.sound_set = now.0;
        if let Some(sound) = &self.sound {
            sound.set(self.clock.is_playing(), self.clock.time(now));
        }
    }

    /// Does what was asked for, or says what the window must do.
    pub(crate) fn act(
        &mut self,
        action: Action,
        stage: &mut Stage,
        pane: &Pane,
        now: Seconds,
    ) -> Wish {
        match action {
            Action::Pause if self.clock.is_playing() => self.pause(stage, now),
            Action::Pause => self.play(now),
            Action::Skip(seconds) => {
                let to = self.clock.time(now).0 + seconds;
                self.seek(stage, Seconds(to), now);
            }
            Action::Step(frames) => self.step_frames(stage, frames, now),
            Action::First => self.seek_in_round(stage, 0, now),
            Action::Last => self.seek_in_round(stage, stage.timeline().frames() - 1, now),
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
            Action::HeatMap => self.heat_map = !self.heat_map,
            Action::Borders => self.borders = !self.borders,
            Action::Overlay => self.overlay = !self.overlay,
            Action::Screenshot => return Wish::Screenshot,
            Action::FullScreen => return Wish::FullScreen,
            Action::Quit => return Wish::Quit,
        }
        Wish::Nothing
    }

    /// Stays at the frame that is on screen.
    fn pause(&mut self, stage: &Stage, now: Seconds) {
        let timeline = stage.timeline();
        let due = timeline.tick_at(self.clock.time(now));
        let tick = stage.shown_tick().unwrap_or(due);
        self.clock.pause(timeline.time_of(tick));
        self.set_sound(now);
    }

    fn seek(&mut self, stage: &mut Stage, to: Seconds, now: Seconds) {
        self.clock.seek(to, now);
        self.set_sound(now);
        stage.jump();
    }

    fn seek_in_round(&mut self, stage: &mut Stage, frame: u64, now: Seconds) {
        let timeline = stage.timeline();
        let tick = timeline.tick_at(self.clock.time(now));
        let begin = tick - tick % timeline.frames();
        let to = timeline.time_of(begin + frame);
        self.seek(stage, to, now);
    }

    fn step_frames(&mut self, stage: &mut Stage, frames: i64, now: Seconds) {
        if self.clock.is_playing() {
            self.pause(stage, now);
        }
        let timeline = stage.timeline();
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

    fn next_policy(&mut self, by: i32, stage: &mut Stage, now: Seconds) {
        let count = POLICIES.len();
        let at = POLICIES.iter().position(|p| *p == self.choice.policy());
        let step = if by > 0 { 1 } else { count - 1 };
        let following = (1..=count).map(|k| POLICIES[(at.unwrap_or(0) + k * step) % count]);
        let possible = following
            .into_iter()
            .find(|policy| self.choice.can(*policy));
        let Some(policy) = possible else {
            return;
        };
        match self.policy.config_of(policy) {
            Ok(config) => {
                self.choice.change(config);
                stage.forget_choice();
                self.say(format!("policy {}", name_of(policy)), now);
            }
            Err(error) => self.say(error.to_string(), now),
        }
    }

    /// Shows a message for some seconds.
    pub(crate) fn say(&mut self, message: String, now: Seconds) {
        self.message = Some((message, now.0 + MESSAGE_S));
    }

    /// Looks where the viewer looks and moves the stage on. Returns whether to paint anew.
    pub(crate) fn step(
        &mut self,
        stage: &mut Stage,
        pane: &Pane,
        now: Seconds,
    ) -> anyhow::Result<bool> {
        self.follow_sound(stage, now);
        self.stay_at_the_end(stage, now);
        let aim = self.aim(stage, pane, now);
        let step = Now {
            wall: now,
            media: self.clock.time(now),
            playing: self.is_moving(stage),
            aim,
        };
        let mut changed = stage.step(&step, &mut self.choice, &mut self.figures)?;
        let shown = self.scene.shown(pane);
        if let Some((before, shown_before)) = &self.last {
            let marked = self.heat_map && before.gaze.gaze_in_content != aim.gaze.gaze_in_content;
            changed |= *shown_before != shown || marked;
        }
        self.last = Some((aim, shown));
        if self
            .message
            .as_ref()
            .is_some_and(|(_, until)| now.0 >= *until)
        {
            self.message = None;
            changed = true;
        }
        let stale = self.overlay && now.0 - self.painted >= FIGURES_S;
        Ok(changed || stale && self.is_moving(stage))
    }

    /// Whether the content moves.
    fn is_moving(&self, stage: &Stage) -> bool {
        self.clock.is_playing() && !stage.timeline().is_still()
    }

    fn follow_sound(&mut self, stage: &Stage, now: Seconds) {
        if self.sound.as_ref().is_some_and(Sound::waits) {
            self.set_sound(now);
        }
        let heard = self.sound.as_ref().and_then(Sound::heard);
        if let Some(heard) = heard.filter(|_| self.is_moving(stage)) {
            self.clock.follow(heard, now);
        }
    }

    fn stay_at_the_end(&mut self, stage: &Stage, now: Seconds) {
        let timeline = stage.timeline();
        let last = timeline.frames() - 1;
        let over = self.clock.time(now).0 >= timeline.length().0;
        if self.once && over && self.clock.is_playing() {
            self.clock.pause(timeline.time_of(last));
            self.set_sound(now);
        }
    }

    /// What selection is given, with the head turned to where it points.
    fn aim(&mut self, stage: &Stage, pane: &Pane, now: Seconds) -> Aim {
        let behind_sound = self.behind_sound(stage, now);
        let watched = Watched {
            now,
            pointer: &self.pointer,
            perception: self.choice.perception(),
        };
        let scene = &mut self.scene;
        let aim = self.looking.aim(&watched, |head| {
            if let Some(head) = head {
                scene.look_along(head);
            }
            scene.shown(pane)
        });
        Aim {
            head: self.scene.head(),
            behind_sound,
            ..aim
        }
    }

    /// How far the frame on screen is from what is heard; 0 while that frame lasts.
    fn behind_sound(&mut self, stage: &Stage, now: Seconds) -> Option<Seconds> {
        let heard = self.sound.as_ref()?.heard()?;
        let tick = stage.shown_tick()?;
        let [begin, end] = [tick, tick + 1].map(|tick| stage.timeline().time_of(tick).0);
        let behind = (heard.0 - end).max(0.0) + (heard.0 - begin).min(0.0);
        if now.0 - self.sound_set > SOUND_BEGINS_S {
            self.worst_sound = self.worst_sound.max(behind.abs());
        }
        Some(Seconds(behind))
    }

    /// Whether nothing on screen is going to change by itself, or it plays.
    pub(crate) fn is_settled(&self, stage: &Stage) -> bool {
        let behind = |(aim, _): &(Aim, Shown)| stage.is_behind(aim, &self.choice);
        if self.is_moving(stage) {
            return stage.shown_tick().is_some();
        }
        stage.is_settled() && !self.last.as_ref().is_none_or(behind)
    }

    /// When to step again though nothing happens, by the window's clock.
    pub(crate) fn next_step(&self, stage: &Stage, now: Seconds) -> Option<Seconds> {
        let mut times = Vec::new();
        if self.is_moving(stage) {
            let media = self.clock.time(now).0;
            let due = stage.next_due().map_or(media, |due| due.0);
            // What is overdue comes with the tiles that are waited for.
            times.push(now.0 + if due > media { due - media } else { 0.02 });
            times.push(if self.overlay {
                self.painted + FIGURES_S
            } else {
                f64::MAX
            });
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
        times.extend(self.message.as_ref().map(|(_, until)| *until));
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

    /// What is drawn over the picture.
    pub(crate) fn marks(&self) -> Option<Overlay> {
        let (aim, shown) = self.last.as_ref()?;
        if !self.heat_map && !self.borders {
            return None;
        }
        let direction = aim.gaze.gaze_in_content;
        let place = shown.view.place(direction).unwrap_or([-1e6; 2]);
        let seen = shown.view.seen_direction(direction).unwrap_or(direction);
        let ppd = shown.view.as_seen().ppd_towards(seen).0;
        let plain = Overlay::default();
        Some(Overlay {
            gaze: place.map(|place| place as f32),
            gaze_radius: if self.heat_map {
                (ppd * FOVEA_DEG) as f32
            } else {
                0.0
            },
            heat: if self.heat_map { plain.heat } else { 0.0 },
            borders: if self.borders { 0.5 } else { 0.0 },
            ..plain
        })
    }

    /// What is written over the picture: figures where they are wanted, and a message.
    pub(crate) fn words(
        &mut self,
        stage: &Stage,
        now: Seconds,
    ) -> (Option<Vec<Line>>, Option<String>) {
        self.painted = now.0;
        let lines = self.overlay.then(|| self.lines(stage, now));
        let message = self.message.as_ref().map(|(message, _)| message.clone());
        (lines, message)
    }

    fn lines(&mut self, stage: &Stage, now: Seconds) -> Vec<Line> {
        let [fps, upload] = self.figures.rates(now);
        let timeline = stage.timeline();
        let media = self.clock.time(now);
        let frame = stage.shown_tick().map_or(0, |tick| timeline.frame_of(tick));
        let state = if self.is_moving(stage) {
            ""
        } else {
            ", paused"
        };
        let figures = &self.figures;
        let levels: Vec<String> = figures.histogram.iter().map(ToString::to_string).collect();
        let line = |what: &str, value: String| (what.to_owned(), value);
        let mut lines = vec![
            line("policy", name_of(self.choice.policy())),
            line(
                "time",
                format!(
                    "{:.2} of {:.2} s, frame {frame}{state}",
                    timeline.within(media).0,
                    timeline.length().0
                ),
            ),
            line("zoom", format!("{:.2}", self.scene.zoom())),
            line("shown", format!("{fps:.1} frames/s")),
            line("decode", format!("{:.1} ms a frame", figures.decode_ms)),
            line("upload", format!("{upload:.1} MB/s")),
            line(
                "pixels",
                format!("{:.2} % of the finest", figures.share * 100.0),
            ),
            line("tiles by level", levels.join(" / ")),
            line(
                "GPU memory",
                format!("{:.1} MB", figures.gpu_bytes as f64 / 1e6),
            ),
            line(
                "late / left out",
                format!(
                    "{} / {} frames",
                    figures.late_frames, figures.left_out_frames
                ),
            ),
            line(
                "damaged",
                format!(
                    "{} tiles, {} frames",
                    figures.damaged_tiles, figures.damaged_frames
                ),
            ),
            line(
                "recovered",
                format!(
                    "{} lost devices, {} errors",
                    figures.lost_devices, figures.gpu_errors
                ),
            ),
        ];
        if let Some(sound) = &self.sound {
            let worst = self.worst_sound * 1e3;
            let gaps = sound.gaps();
            lines.push(line("sound", format!("within {worst:.0} ms, {gaps} gaps")));
        }
        lines
    }

    /// Greatest distance of picture and sound, where there is sound.
    pub(crate) fn worst_sound(&self) -> Option<Seconds> {
        self.sound.as_ref().map(|_| Seconds(self.worst_sound))
    }
}

/// A policy as it is called on the command line.
fn name_of(policy: Policy) -> String {
    format!("{policy:?}").to_lowercase()
}
