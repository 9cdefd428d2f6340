//! Does a viewer stay where it should in time, and follow what it should?

use super::*;
use crate::content::demand::Content;
use crate::content::policy::{Policy, PolicyConfig};
use crate::content::video::Video;
use crate::content::video::bytes::build::{begin_pack, finish_pack, push_tile};
use crate::content::video::bytes::codec::Codec;
use crate::content::video::bytes::description::{Description, Source};
use crate::content::video::bytes::pack::VideoPack;
use crate::content::video::grid::tile_grid::Cut;
use crate::pack::{HEADER_BYTES, Header};
use crate::session::actions::{SessionAction, SessionEvent};
use crate::session::bounds::Bounds;
use crate::session::session::SessionSettings;
use crate::units::Radians;
use crate::view::picture::{Colour, Matrix};
use crate::view::surface::{Mapping, Projection, Screen, Surface};
use proptest::prelude::*;
use std::sync::Arc;

const SIZE: [u32; 2] = [32, 32];
const FRAMES: u32 = 50;
const PERIOD: f64 = 1.0 / 25.0;
/// Length of a round.
const ROUND: f64 = 2.0;

/// A video of one tile.
fn video(frames: u32) -> Video {
    let about = Description {
        generator: String::new(),
        projection: Projection::Flat,
        size: SIZE,
        eyes: 1,
        cube_faces: 6,
        mapping: Mapping::Gnomonic,
        pixel_aspect: [1, 1],
        front_deg: 0.0,
        cut: Cut::Tile(32),
        levels: 1,
        ratio: 2,
        codec: Codec::Png,
        quality: vec![0],
        quality_scale: Default::default(),
        quality_by_tile: false,
        bit_rates: Vec::new(),
        groups: vec![1],
        frames,
        frame_rate: [25, 1],
        colour: Colour {
            matrix: Matrix::Bt709,
            full_range: false,
            chroma_left: false,
        },
        source: Source {
            name: String::new(),
            size: SIZE,
            bytes: 1,
            codec: String::new(),
        },
        identity: None,
        loss: None,
        last_frame_s: None,
        remarks: Vec::new(),
        repairs: Default::default(),
        tables: Vec::new(),
    };
    let mut builder = begin_pack(&about);
    for frame in 0..frames {
        for tile in about.grid(Screen::default()).tiles_of(0) {
            push_tile(&mut builder, tile, frame, &[vec![7]]);
        }
    }
    let parts = finish_pack(builder, about, &[]).unwrap();
    let header = Header::parse(&parts.head).unwrap();
    let pack = VideoPack::parse(&header, &parts.head[HEADER_BYTES..], &parts.tail).unwrap();
    Video::new("video", Arc::new(pack), Screen::default())
}

/// A viewer before a session whose units come as soon as they are wanted.
struct Trial {
    viewer: Viewer,
    session: Session,
}

impl Trial {
    fn new(at_end: AtEnd) -> Self {
        Self::over(FRAMES, at_end)
    }

    fn over(frames: u32, at_end: AtEnd) -> Self {
        let settings = SessionSettings {
            bounds: Bounds::default(),
            policy: PolicyConfig::new(Policy::Full),
            bytes_per_s: None,
            since: None,
            zooms: false,
            measures: false,
        };
        let video: Arc<dyn Content> = Arc::new(video(frames));
        let surface = Surface::flat(SIZE, Screen::default());
        let viewer = ViewerSettings {
            plays: true,
            at_end,
            holds_early: true,
        };
        Self {
            viewer: Viewer::new(Navigation::new(surface, Radians(1.0)), viewer),
            session: Session::new(vec![video], settings),
        }
    }

    /// The same, begun at 0 and with a first frame on screen.
    fn begun(at_end: AtEnd) -> Self {
        let mut trial = Self::new(at_end);
        trial.viewer.begin(Seconds(0.0));
        trial.step(0.0);
        trial.step(0.0);
        trial
    }

    fn step(&mut self, now: f64) -> bool {
        let pane = Pane::new(SIZE, [1920, 1080], Screen::default());
        let shown = self.viewer.shown(&pane);
        let gaze = self.viewer.pointer.gaze(Seconds(now), &shown);
        let moment = Moment::new(gaze, vec![shown.view]);
        let step = self.viewer.now(&self.session, &moment, Seconds(now));
        for action in self.session.step(&step) {
            if let SessionAction::Want(pieces) = action {
                for piece in pieces {
                    let event = SessionEvent::Decoded { piece, frames: 1 };
                    self.session.take(event);
                }
            }
        }
        self.viewer.stepped(moment, &pane, true)
    }

    /// Steps as often as a screen does.
    fn play(&mut self, from: f64, until: f64) {
        let steps = ((until - from) * 100.0) as u32;
        (0..=steps).for_each(|step| {
            self.step(from + f64::from(step) * 0.01);
        });
    }

    fn time(&self, now: f64) -> f64 {
        self.viewer.time(Seconds(now)).0
    }

    fn shown_frame(&self) -> u64 {
        self.session.shown_tick().unwrap() % u64::from(FRAMES)
    }

    /// The session, for a viewer to change.
    fn parts(&mut self) -> (&mut Viewer, &mut Session) {
        (&mut self.viewer, &mut self.session)
    }
}

#[test]
fn time_begins_when_it_is_told_and_who_paused_before_stays_paused() {
    let mut trial = Trial::new(AtEnd::GoesRound);
    assert!(trial.viewer.is_playing() && !trial.viewer.is_moving(&trial.session));
    assert_eq!(trial.time(9.0), 0.0);
    trial.viewer.begin(Seconds(9.0));
    assert!((trial.time(9.1) - 0.1).abs() < 1e-9);
    let mut paused = Trial::new(AtEnd::GoesRound);
    paused.viewer.pause(&paused.session, Seconds(1.0));
    paused.viewer.begin(Seconds(2.0));
    assert!(!paused.viewer.is_playing());
    assert_eq!(paused.time(3.0), 0.0);
}

#[test]
fn pausing_stays_at_the_frame_on_screen_however_late_that_is() {
    let mut trial = Trial::begun(AtEnd::GoesRound);
    trial.play(0.0, 0.4);
    let tick = trial.session.shown_tick().unwrap();
    // Nothing was shown for a while.
    trial.viewer.pause(&trial.session, Seconds(1.7));
    assert!((trial.time(5.0) - tick as f64 * PERIOD).abs() < 1e-9);
    trial.play(5.0, 5.5);
    assert_eq!(trial.session.shown_tick(), Some(tick));
}

#[test]
fn at_the_end_it_stays_where_that_is_asked_for_and_else_it_goes_round() {
    for at_end in [AtEnd::GoesRound, AtEnd::Stays, AtEnd::StaysUntilPlayed] {
        let mut trial = Trial::begun(at_end);
        let stays = at_end != AtEnd::GoesRound;
        let stay = |trial: &mut Trial, now| {
            let Trial { viewer, session } = trial;
            viewer.stay_at_the_end(session, Seconds(now))
        };
        assert!(!stay(&mut trial, ROUND - 0.01));
        assert_eq!(stay(&mut trial, ROUND + 0.01), stays);
        assert!(!stay(&mut trial, ROUND + 0.02), "it is reported once");
        assert_eq!(trial.viewer.is_playing(), !stays);
        let last = ROUND - PERIOD;
        let later = if stays { last } else { ROUND + 0.5 };
        assert!((trial.time(ROUND + 0.5) - later).abs() < 1e-9);

        let (viewer, session) = trial.parts();
        viewer.play(session, Seconds(9.0));
        let begins = match at_end {
            AtEnd::GoesRound => 9.0,
            AtEnd::Stays => last,
            AtEnd::StaysUntilPlayed => 0.0,
        };
        assert!((trial.time(9.0) - begins).abs() < 1e-9, "{at_end:?}");
    }
}

#[test]
fn who_seeks_after_the_end_plays_on_from_there() {
    let mut trial = Trial::begun(AtEnd::StaysUntilPlayed);
    let (viewer, session) = trial.parts();
    assert!(viewer.stay_at_the_end(session, Seconds(ROUND + 0.01)));
    viewer.seek(session, Seconds(0.3), Seconds(8.0));
    viewer.play(session, Seconds(9.0));
    assert!((trial.time(9.1) - 0.4).abs() < 1e-9);
}

#[test]
fn before_the_first_frame_comes_the_last() {
    let mut trial = Trial::begun(AtEnd::GoesRound);
    let (viewer, session) = trial.parts();
    viewer.step_frames(session, -1, Seconds(0.01));
    assert!(!viewer.is_playing());
    trial.play(1.0, 1.5);
    assert_eq!(trial.shown_frame(), u64::from(FRAMES) - 1);
    let (viewer, session) = trial.parts();
    viewer.step_frames(session, 1, Seconds(2.0));
    trial.play(2.0, 2.5);
    assert_eq!(trial.shown_frame(), 0);
}

#[test]
fn after_the_last_frame_of_what_stays_at_its_end_comes_none() {
    for at_end in [AtEnd::Stays, AtEnd::StaysUntilPlayed] {
        let mut trial = Trial::begun(at_end);
        let (viewer, session) = trial.parts();
        viewer.seek_last(session, Seconds(0.1));
        viewer.step_frames(session, 1, Seconds(0.2));
        trial.play(0.3, 0.8);
        assert_eq!(trial.shown_frame(), u64::from(FRAMES) - 1, "{at_end:?}");
    }
}

#[test]
fn who_seeks_and_pauses_before_the_picture_comes_stays_where_that_is() {
    let mut trial = Trial::begun(AtEnd::GoesRound);
    trial.play(0.0, 0.1);
    let (viewer, session) = trial.parts();
    viewer.seek(session, Seconds(0.5), Seconds(0.11));
    viewer.pause(session, Seconds(0.12));
    let time = trial.time(1.0);
    assert!((0.5 - PERIOD..=0.52).contains(&time), "{time}");
}

#[test]
fn what_is_heard_of_a_round_is_followed_in_the_nearest_one() {
    let mut trial = Trial::begun(AtEnd::GoesRound);
    // At the end of the second round the sound has begun the third.
    let now = 2.0 * ROUND - 0.05;
    let heard = Heard::InRound(Seconds(0.05));
    trial.viewer.hear(&trial.session, heard, Seconds(now));
    let time = trial.time(now);
    assert!(time > now && time <= 2.0 * ROUND + 0.05, "{time}");
    // And the other way round.
    let now = now + 0.2;
    let before = trial.time(now);
    let heard = Heard::InRound(Seconds(ROUND - 0.01));
    trial.viewer.hear(&trial.session, heard, Seconds(now));
    let time = trial.time(now);
    assert!(
        time < before && time >= 2.0 * ROUND - 0.01,
        "{before} {time}"
    );
}

#[test]
fn where_sound_begins_it_waits_and_then_goes_on_with_it() {
    let mut trial = Trial::begun(AtEnd::GoesRound);
    let hear = |trial: &mut Trial, heard, now| {
        let Trial { viewer, session } = trial;
        viewer.hear(session, heard, Seconds(now));
    };
    for step in 0..20 {
        let now = 0.1 + f64::from(step) * 0.01;
        hear(&mut trial, Heard::Begins(Seconds(0.5), None), now);
        assert_eq!(trial.time(now), 0.5);
    }
    // At once, without gliding.
    hear(&mut trial, Heard::At(Seconds(0.51)), 0.3);
    assert_eq!(trial.time(0.3), 0.51);
    hear(&mut trial, Heard::At(Seconds(0.71)), 0.4);
    assert!((0.61..0.71).contains(&trial.time(0.4)));
    // What stands is in step with anything.
    trial.viewer.pause(&trial.session, Seconds(0.5));
    let before = trial.time(0.6);
    hear(&mut trial, Heard::At(Seconds(0.0)), 0.6);
    assert_eq!(trial.time(0.6), before);
}

#[test]
fn what_is_slowly_drawn_is_chosen_for_when_it_is_drawn_and_held_back_until_then() {
    let mut trial = Trial::begun(AtEnd::GoesRound);
    let (viewer, session) = trial.parts();
    assert!(!viewer.holds_back(session));
    (0..9).for_each(|_| viewer.drawn(session, Some(Seconds(0.1))));
    trial.play(0.01, 0.5);
    let before = trial.session.shown_tick();
    let mut now = 0.5;
    while trial.session.shown_tick() == before {
        now += 0.01;
        trial.step(now);
    }
    let Trial { viewer, session } = &trial;
    assert!(viewer.holds_back(session) && !viewer.is_drawn(session));
    let begins = session.timeline().time_of(session.shown_tick().unwrap()).0;
    let early = viewer.early_by(session, Seconds(now)).0;
    assert!((early - (begins - now)).abs() < 1e-9);
    assert!((0.08..=0.1).contains(&early), "{early}");
    assert_eq!(viewer.early_by(session, Seconds(1.0)), Seconds(0.0));
    let (viewer, session) = trial.parts();
    viewer.drawn(session, None);
    assert!(viewer.is_drawn(session) && !viewer.holds_back(session));
}

#[test]
fn a_view_that_moves_is_drawn_anew_and_a_gaze_where_it_is_seen() {
    let mut trial = Trial::begun(AtEnd::GoesRound);
    trial.viewer.pause(&trial.session, Seconds(0.0));
    trial.play(0.0, 0.5);
    assert!(!trial.step(0.5) && trial.viewer.is_settled(&trial.session));
    assert_eq!(trial.viewer.next_step(&trial.session, Seconds(0.5)), None);
    trial.viewer.pointer.move_to([3.0, 4.0]);
    assert!(trial.step(0.6));
    let fovea = trial.viewer.fovea().unwrap();
    assert!((fovea.place[0] - 3.0).abs() < 1e-6 && fovea.radius > 0.0);
    let pane = Pane::new(SIZE, [1920, 1080], Screen::default());
    trial.viewer.navigation.zoom_by(2.0, [3.0, 4.0], &pane);
    assert!(trial.step(0.7));
    // A pointer that left is looked at again when it is forgotten.
    trial.viewer.pointer.leave(Seconds(0.7));
    trial.play(0.7, 0.9);
    let next = trial.viewer.next_step(&trial.session, Seconds(0.9));
    assert_eq!(next, trial.viewer.pointer.forgotten());
}

#[test]
fn a_picture_that_changes_by_itself_is_stepped_soon_until_it_does_not() {
    let mut trial = Trial::over(1, AtEnd::GoesRound);
    trial.viewer.begin(Seconds(0.0));
    trial.play(0.0, 0.5);
    trial.viewer.set_morphing(true);
    assert!(!trial.viewer.is_settled(&trial.session));
    let next = trial.viewer.next_step(&trial.session, Seconds(0.5));
    assert!(next.is_some_and(|next| next.0 < 0.52), "{next:?}");
    trial.viewer.set_morphing(false);
    assert!(trial.viewer.is_settled(&trial.session));
    assert_eq!(trial.viewer.next_step(&trial.session, Seconds(0.5)), None);
}

#[test]
fn a_still_never_moves() {
    let mut trial = Trial::over(1, AtEnd::GoesRound);
    trial.viewer.begin(Seconds(0.0));
    trial.play(0.0, 0.5);
    assert!(trial.viewer.is_playing() && !trial.viewer.is_moving(&trial.session));
    assert!(trial.viewer.is_settled(&trial.session));
}

proptest! {
    #[test]
    fn going_elsewhere_never_leaves_the_round(at in 0.0..100.0f64, by in -9.0..9.0f64) {
        let mut trial = Trial::begun(AtEnd::GoesRound);
        let round = |time: f64| (time / ROUND + 1e-6).floor();
        let (viewer, session) = trial.parts();
        let wanted = round(viewer.time(Seconds(at)).0);
        viewer.skip(session, by, Seconds(at));
        prop_assert_eq!(round(viewer.time(Seconds(at)).0), wanted);
        viewer.seek_last(session, Seconds(at));
        let last = viewer.time(Seconds(at)).0;
        prop_assert_eq!(round(last), wanted);
        viewer.seek_first(session, Seconds(at));
        let first = viewer.time(Seconds(at)).0;
        prop_assert!((last - first - (ROUND - PERIOD)).abs() < 1e-6);
    }
}
