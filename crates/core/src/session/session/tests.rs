//! Does the right frame come on screen, however slow or broken its units are?

use super::*;
use crate::content::demand::{Chosen, Demand};
use crate::content::head::ContentHead;
use crate::content::policy::HasTables;
use crate::content::scripted::scripted_head;
use crate::content::unit::Unit;
use crate::gaze::sample::GazeSample;
use crate::pack::unit::UnitId;
use crate::pack::{Entry, UnitPlace};
use crate::perception::moment::Moment;
use crate::units::Radians;
use crate::view::axes::Axes;
use crate::view::eye_view::{EyeView, Field};
use crate::view::surface::Surface;
use glam::DVec3;
use std::sync::atomic::{AtomicBool, Ordering};

const PERIOD: f64 = 1.0 / 30.0;
/// Time from one step to the next.
const STEP: f64 = 0.005;
const FRAMES: u32 = 300;

/// Frames of a group.
const GROUP: u32 = 8;

/// One coarse and four fine units a group, all of them wanted.
#[derive(Clone, Debug, Default)]
struct Film {
    /// Something that choosing takes has not been loaded.
    lacks: Arc<AtomicBool>,
}

/// The units of the group of a frame, the coarse one first.
fn units_at(frame: u32) -> impl Iterator<Item = UnitId> {
    (0..5).map(move |number| UnitId(frame / GROUP * 5 + number))
}

impl Content for Film {
    fn name(&self) -> &str {
        "film"
    }

    fn timeline(&self) -> Timeline {
        let times = (0..FRAMES).map(|n| (f64::from(n) * PERIOD * 1e9) as i64);
        Timeline::new(&times.collect::<Vec<_>>(), Seconds(PERIOD))
    }

    fn unit(&self, unit: UnitId) -> Unit {
        let (level, group) = (u8::from(unit.0.is_multiple_of(5)), unit.0 / 5);
        Unit {
            level,
            bytes: Some(100),
            samples: 1024,
            gpu_bytes: 1536,
            frames: group * GROUP..(group + 1) * GROUP,
        }
    }

    fn place(&self, _: UnitId) -> UnitPlace {
        UnitPlace::At(Entry::default())
    }

    fn base(&self, frame: u32) -> Vec<UnitId> {
        units_at(frame).take(1).collect()
    }

    fn coarsest(&self) -> u8 {
        1
    }

    fn at_frame(&self, unit: UnitId, frame: u32) -> UnitId {
        UnitId(frame / GROUP * 5 + unit.0 % 5)
    }

    fn direction(&self, unit: UnitId, _: DVec3) -> DVec3 {
        DVec3::new(f64::from(unit.0 % 5), 0.0, -1.0).normalize()
    }

    fn finest_samples(&self) -> u64 {
        4096
    }

    fn has(&self) -> HasTables {
        HasTables {
            signatures: false,
            cues: false,
        }
    }

    fn is_ready(&self, _: &PolicyConfig, _: u32) -> bool {
        !self.lacks.load(Ordering::Relaxed)
    }

    fn demand(self: Arc<Self>, _: &ContentHead, _: &PolicyConfig) -> Box<dyn Demand> {
        Box::new(Self::clone(&self))
    }

    fn head(&self) -> ContentHead {
        scripted_head(Surface::cube(1024))
    }
}

impl Demand for Film {
    fn needed(&mut self, frame: u32, _: &Moment) -> Chosen {
        Chosen {
            units: units_at(frame).collect(),
            ..Chosen::default()
        }
    }
}

/// A session, its clock, and a decoder that brings every piece some time after it was first wanted,
/// or finds it damaged.
struct Trial {
    session: Session,
    lacks: Arc<AtomicBool>,
    now: f64,
    takes: f64,
    damaged: bool,
    /// Whether everything comes twice.
    twice: bool,
    /// When what is wanted will be there.
    under_way: Vec<(f64, Piece)>,
    cache: HashSet<Piece>,
    /// How long a picture is drawn, as far as it is known.
    drawing: f64,
}

impl Trial {
    fn new(takes: f64) -> Self {
        let settings = SessionSettings {
            policy: PolicyConfig::new(crate::content::policy::Policy::Full),
            bytes_per_s: None,
            since: None,
            zooms: false,
            measures: false,
            bounds: Bounds::default(),
        };
        let film = Film::default();
        let lacks = Arc::clone(&film.lacks);
        Self {
            session: Session::new(vec![Arc::new(film)], settings),
            lacks,
            now: 0.0,
            takes,
            damaged: false,
            twice: false,
            under_way: Vec::new(),
            cache: HashSet::new(),
            drawing: 0.0,
        }
    }

    /// Plays for some seconds.
    fn play(&mut self, seconds: f64) {
        let until = self.now + seconds;
        while self.now < until {
            self.step(true);
        }
    }

    fn step(&mut self, playing: bool) {
        let wall = self.now;
        let (ready, under_way) = self.under_way.drain(..).partition(|(at, _)| *at <= wall);
        self.under_way = under_way;
        for (_, piece) in Vec::into_iter(ready) {
            let event = if self.damaged {
                SessionEvent::Damaged { piece, frames: 1 }
            } else {
                self.cache.insert(piece);
                SessionEvent::Decoded { piece, frames: 1 }
            };
            self.session.take(event.clone());
            if self.twice {
                self.session.take(event);
            }
        }
        let now = Now {
            wall: Seconds(wall),
            media: Seconds(if playing { wall + self.drawing } else { 0.0 }),
            pace: if playing {
                Pace::Playing
            } else {
                Pace::Standing
            },
            drawing: Seconds(self.drawing),
            until: Seconds(wall),
            moment: moment(wall),
        };
        for action in self.session.step(&now) {
            self.obey(action);
        }
        self.now = wall + STEP;
    }

    fn obey(&mut self, action: SessionAction) {
        match action {
            SessionAction::Want(pieces) => {
                self.under_way.retain(|(_, piece)| pieces.contains(piece));
                for piece in pieces {
                    if !self.under_way.iter().any(|(_, known)| *known == piece) {
                        self.under_way.push((self.now + self.takes, piece));
                    }
                }
            }
            SessionAction::Upload(piece) => {
                assert!(self.cache.remove(&piece), "{piece:?} is not there");
            }
            SessionAction::Drop(piece) => {
                let was_there = self.cache.remove(&piece);
                assert!(was_there, "{piece:?} is not there");
            }
            _ => {}
        }
    }

    fn due(&self) -> u64 {
        self.session.timeline.tick_at(Seconds(self.now))
    }
}

fn moment(wall: f64) -> Moment {
    let size = [64, 64];
    let view = EyeView {
        position: Default::default(),
        axes: Axes::FRONT,
        field: Field::across(Radians::from_degrees(60.0), size),
        size,
        eye: Default::default(),
    };
    let gaze = GazeSample::at(Seconds(wall), Radians(0.0), Radians(0.0));
    Moment::new(gaze, vec![view])
}

#[test]
fn every_frame_comes_in_time_when_its_tiles_do() {
    let mut trial = Trial::new(0.01);
    trial.play(2.0);
    let figures = &trial.session.figures;
    assert_eq!((figures.left_out_frames, figures.late_frames), (0, 0));
    assert!(figures.frames >= 59, "{}", figures.frames);
    assert_eq!(trial.session.lead, 0.0);
}

#[test]
fn frames_that_take_longer_than_they_last_are_begun_earlier_and_then_later_again() {
    let mut trial = Trial::new(2.5 * PERIOD);
    trial.play(2.0);
    assert!(trial.session.lead > PERIOD, "{}", trial.session.lead);
    let [late, shown] = [
        trial.session.figures.late_frames,
        trial.session.figures.frames,
    ];
    trial.play(4.0);
    let late = trial.session.figures.late_frames - late;
    let shown = trial.session.figures.frames - shown;
    assert!(shown > 40 && late < shown / 3, "{late} late of {shown}");
    trial.takes = 0.01;
    trial.play(3.0);
    assert!(trial.session.lead < 0.01, "{}", trial.session.lead);
}

#[test]
fn what_follows_a_frame_that_is_long_drawn_is_the_frame_of_the_time_when_it_is_drawn() {
    let takes = 6.5 * PERIOD;
    let mut trial = Trial::new(0.01);
    // The frame after the first is begun before anybody knows.
    while trial.session.shown_tick().is_none() || trial.session.coming.is_none() {
        trial.step(true);
    }
    let mut drawn = trial.session.shown_tick();
    trial.drawing = takes;
    for _ in 0..1000 {
        trial.step(true);
        if trial.session.shown_tick() == drawn {
            continue;
        }
        drawn = trial.session.shown_tick();
        let begun = trial.now - STEP;
        trial.now = begun + takes;
        let [at, due] = [drawn.unwrap(), trial.due()];
        assert!(at.abs_diff(due) <= 1, "{at} is drawn when {due} is due");
    }
    assert!(trial.session.figures.frames > 20);
}

#[test]
fn damaged_frames_are_given_up_as_they_fall_due_and_what_follows_is_shown() {
    let mut trial = Trial::new(0.001);
    trial.play(0.5);
    trial.damaged = true;
    trial.play(2.0);
    let given_up = trial.session.figures.damaged_frames;
    assert!((55..=62).contains(&given_up), "{given_up} in two seconds");
    trial.damaged = false;
    trial.play(0.2);
    let shown = trial.session.shown_tick().unwrap();
    assert!(shown + 2 >= trial.due(), "{shown} of {}", trial.due());
}

#[test]
fn a_picture_that_stays_is_refined_until_nothing_is_missing() {
    let mut trial = Trial::new(0.05);
    (0..40).for_each(|_| trial.step(false));
    assert!(trial.session.is_settled());
}

#[test]
fn what_stays_while_something_is_awaited_is_of_the_frame_that_comes() {
    let mut trial = Trial::new(0.001);
    trial.play(0.2);
    trial.lacks.store(true, Ordering::Relaxed);
    let before = trial.session.figures.frames;
    for _ in 0..60 {
        trial.step(true);
        for Piece { unit, frame } in trial.session.wanted().unwrap().1 {
            assert!(
                units_at(*frame).any(|known| known == unit.unit),
                "{unit:?} at {frame}"
            );
        }
    }
    assert!(trial.session.figures.frames >= before + 8);
}

#[test]
fn what_comes_twice_is_shown_all_the_same() {
    let mut trial = Trial::new(0.01);
    trial.twice = true;
    trial.play(1.0);
    let figures = &trial.session.figures;
    assert!(
        figures.frames >= 29 && figures.incomplete_frames == 0,
        "{figures:?}"
    );
}
