//! Does the right frame come on screen, however slow or broken its tiles are?

use super::*;
use crate::content::video::grid::tile_grid::Cut;
use crate::gaze::sample::{GazeSample, HeadPose};
use crate::perception::parameters::EyeState;
use crate::units::Radians;
use crate::view::eye_view::EyeView;
use crate::view::surface::{Screen, Surface};
use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

const PERIOD: f64 = 1.0 / 30.0;
/// Time from one step to the next.
const STEP: f64 = 0.005;
const FRAMES: usize = 300;

/// Brings every tile some time after it was first wanted, or finds it damaged.
struct Slow {
    now: Rc<Cell<f64>>,
    takes: Rc<Cell<f64>>,
    damaged: Rc<Cell<bool>>,
    under_way: Vec<(f64, TileOfFrame)>,
}

impl Feed for Slow {
    type Error = Infallible;

    fn want(&mut self, wanted: Vec<TileOfFrame>) {
        self.under_way.retain(|(_, tile)| wanted.contains(tile));
        for tile in wanted {
            if !self.under_way.iter().any(|(_, known)| *known == tile) {
                let ready = self.now.get() + self.takes.get();
                self.under_way.push((ready, tile));
            }
        }
    }

    fn take(&mut self) -> Result<Vec<Delivery>, Infallible> {
        let now = self.now.get();
        let (ready, under_way) = self.under_way.drain(..).partition(|(at, _)| *at <= now);
        self.under_way = under_way;
        let deliver = |(_, (tile, frame)): (f64, TileOfFrame)| Delivery {
            tile,
            frame,
            decoded: 1,
            picture: (!self.damaged.get()).then(Picture::default),
        };
        Ok(Vec::into_iter(ready).map(deliver).collect())
    }
}

/// Shows nothing and forgets nothing.
struct Wall;

impl Easel for Wall {
    type Error = Infallible;
    fn begin_frame(&mut self, _: u32) {}
    fn upload(&mut self, _: Tile, _: u32, _: Picture) -> Result<(), Infallible> {
        Ok(())
    }
    fn retain(&mut self, _: &[Tile]) {}
    fn wrong_frame_tiles(&mut self) -> usize {
        0
    }
    fn gpu_bytes(&mut self) -> u64 {
        0
    }
}

/// Wants every finest tile.
struct All(TileGrid);

impl Chooses for All {
    type Error = Infallible;
    fn choose(&mut self, _: u32, _: &Aim) -> Result<Vec<Tile>, Infallible> {
        let coarsest = self.0.tiles_of(self.0.coarsest());
        Ok(coarsest.chain(self.0.tiles_of(0)).collect())
    }
    fn differs(&self, _: &Aim, _: &Aim) -> bool {
        false
    }
}

/// A stage and its clock.
struct Trial {
    stage: Stage<Slow, Wall>,
    choice: All,
    now: Rc<Cell<f64>>,
    takes: Rc<Cell<f64>>,
    damaged: Rc<Cell<bool>>,
    /// How long a picture is drawn, as far as it is known.
    drawing: f64,
    figures: Figures,
}

impl Trial {
    fn new(takes: f64) -> Self {
        let surface = Surface::flat([64, 64], Screen::default());
        let grid = TileGrid::new(surface, Cut::Tile(32), 2, 2).unwrap();
        let times: Vec<i64> = (0..FRAMES)
            .map(|n| (n as f64 * PERIOD * 1e9) as i64)
            .collect();
        let now = Rc::new(Cell::new(0.0));
        let takes = Rc::new(Cell::new(takes));
        let damaged = Rc::new(Cell::new(false));
        let feed = Slow {
            now: Rc::clone(&now),
            takes: Rc::clone(&takes),
            damaged: Rc::clone(&damaged),
            under_way: Vec::new(),
        };
        Self {
            stage: Stage::new(grid, Timeline::new(&times, Seconds(PERIOD)), feed, Wall),
            choice: All(grid),
            now,
            takes,
            damaged,
            drawing: 0.0,
            figures: Figures::default(),
        }
    }

    /// Plays for some seconds.
    fn play(&mut self, seconds: f64) {
        let until = self.now.get() + seconds;
        while self.now.get() < until {
            self.step(true);
        }
    }

    fn step(&mut self, playing: bool) {
        let wall = self.now.get();
        let now = Now {
            wall: Seconds(wall),
            media: Seconds(if playing { wall + self.drawing } else { 0.0 }),
            playing,
            drawing: Seconds(self.drawing),
            aim: aim(),
        };
        let (choice, figures) = (&mut self.choice, &mut self.figures);
        self.stage.step(&now, choice, figures).unwrap();
        self.now.set(wall + STEP);
    }

    fn due(&self) -> u64 {
        self.stage.timeline.tick_at(Seconds(self.now.get()))
    }
}

fn aim() -> Aim {
    let surface = Surface::flat([64, 64], Screen::default());
    let ahead = glam::DVec3::NEG_Z;
    Aim {
        gaze: GazeSample {
            time: Seconds(0.0),
            received: Seconds(0.0),
            gaze_in_content: ahead,
            valid: true,
            spread: Radians(0.0),
            head: None,
        },
        view: EyeView::filling(&surface, [64, 64]),
        head: HeadPose::default(),
        state: EyeState::Steady,
        behind_sound: None,
    }
}

#[test]
fn every_frame_comes_in_time_when_its_tiles_do() {
    let mut trial = Trial::new(0.01);
    trial.play(2.0);
    let figures = &trial.figures;
    assert_eq!((figures.left_out_frames, figures.late_frames), (0, 0));
    assert!(figures.frames >= 59, "{}", figures.frames);
    assert_eq!(trial.stage.lead, 0.0);
}

#[test]
fn frames_that_take_longer_than_they_last_are_begun_earlier_and_then_later_again() {
    let mut trial = Trial::new(2.5 * PERIOD);
    trial.play(2.0);
    assert!(trial.stage.lead > PERIOD, "{}", trial.stage.lead);
    let [late, shown] = [trial.figures.late_frames, trial.figures.frames];
    trial.play(4.0);
    let late = trial.figures.late_frames - late;
    let shown = trial.figures.frames - shown;
    assert!(shown > 40 && late < shown / 3, "{late} late of {shown}");
    trial.takes.set(0.01);
    trial.play(3.0);
    assert!(trial.stage.lead < 0.01, "{}", trial.stage.lead);
}

#[test]
fn what_follows_a_frame_that_is_long_drawn_is_the_frame_of_the_time_when_it_is_drawn() {
    let takes = 6.5 * PERIOD;
    let mut trial = Trial::new(0.01);
    // The frame after the first is begun before anybody knows.
    while trial.stage.shown_tick().is_none() || trial.stage.coming.is_none() {
        trial.step(true);
    }
    let mut drawn = trial.stage.shown_tick();
    trial.drawing = takes;
    for _ in 0..1000 {
        trial.step(true);
        if trial.stage.shown_tick() == drawn {
            continue;
        }
        drawn = trial.stage.shown_tick();
        let begun = trial.now.get() - STEP;
        trial.now.set(begun + takes);
        let [at, due] = [drawn.unwrap(), trial.due()];
        assert!(at.abs_diff(due) <= 1, "{at} is drawn when {due} is due");
    }
    assert!(trial.figures.frames > 20);
}

#[test]
fn damaged_frames_are_given_up_as_they_fall_due_and_what_follows_is_shown() {
    let mut trial = Trial::new(0.001);
    trial.play(0.5);
    trial.damaged.set(true);
    trial.play(2.0);
    let given_up = trial.figures.damaged_frames;
    assert!((55..=62).contains(&given_up), "{given_up} in two seconds");
    trial.damaged.set(false);
    trial.play(0.2);
    let shown = trial.stage.shown_tick().unwrap();
    assert!(shown + 2 >= trial.due(), "{shown} of {}", trial.due());
}

#[test]
fn a_picture_that_stays_is_refined_until_nothing_is_missing() {
    let mut trial = Trial::new(0.05);
    (0..40).for_each(|_| trial.step(false));
    assert!(trial.stage.is_settled());
}
