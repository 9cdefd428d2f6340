//! How does an eye fly through a scene?

use super::axes::Axes;
use super::eye_view::Field;
use super::route::EyePose;
use crate::units::{Radians, Seconds};
use glam::DVec3;

/// Radii of the scene that are flown in a second.
const SPEED: f64 = 0.5;
/// How many times faster that is in a hurry.
const HURRY: f64 = 4.0;
/// How long a flight is as far as one step of it.
const STEP: Seconds = Seconds(0.25);
/// Radii of the scene that an eye goes away from its middle at most.
const FARTHEST: f64 = 50.0;
/// The least distance, in radii, that a wheel comes closer by a share of: within the scene, too,
/// it goes on.
const LEAST_DISTANCE: f64 = 0.25;

/// Where a flying viewer steers to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steering {
    /// Whether it goes back or on along the right, up and ahead of the head.
    held: [[bool; 2]; 3],
    /// Faster than usual.
    is_hurried: bool,
}

impl Steering {
    /// The same, but that it goes, or no longer goes, along a direction of the head: to the right,
    /// up and ahead, or against these where a number is negative.
    #[must_use]
    pub fn with(mut self, towards: [f64; 3], is_held: bool) -> Self {
        for (held, along) in self.held.iter_mut().zip(towards) {
            if along != 0.0 {
                held[usize::from(along > 0.0)] = is_held;
            }
        }
        self
    }

    /// The same, faster than usual or not.
    #[must_use]
    pub fn hurried(self, is_hurried: bool) -> Self {
        Self { is_hurried, ..self }
    }

    /// Whether it goes anywhere.
    #[must_use]
    pub fn goes(&self) -> bool {
        self.towards() != DVec3::ZERO
    }

    /// To the right, up and ahead, 1 long or nothing.
    fn towards(&self) -> DVec3 {
        let along = |[back, on]: [bool; 2]| f64::from(u8::from(on)) - f64::from(u8::from(back));
        DVec3::from_array(self.held.map(along)).normalize_or_zero()
    }
}

/// An eye in a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flight {
    /// The middle and the radius of the scene, in metres.
    scene: (DVec3, f64),
    /// From how far above its middle it is looked at in the beginning.
    rise: Radians,
    /// Where the eye is; `None` where it has not left the beginning, which the field decides.
    place: Option<DVec3>,
    steering: Steering,
    /// Up to when it has flown as it steers.
    since: Seconds,
}

impl Flight {
    pub(super) fn new(scene: (DVec3, f64), rise: Radians) -> Self {
        Self {
            scene: (scene.0, scene.1.max(1e-9)),
            rise,
            place: None,
            steering: Steering::default(),
            since: Seconds(0.0),
        }
    }

    /// Where the eye is, in a view of this field.
    pub(super) fn place(&self, field: &Field) -> DVec3 {
        let start = || EyePose::before(self.scene, self.rise, field).position;
        self.place.unwrap_or_else(start)
    }

    /// Back to the beginning.
    pub(super) fn reset(&mut self) {
        self.place = None;
    }

    pub(super) fn steering(&self) -> Steering {
        self.steering
    }

    /// Flies as it was steered up to now, and steers as given from here on.
    pub(super) fn steer(&mut self, steering: Steering, head: (&Axes, &Field), now: Seconds) {
        let seconds = if self.steering.goes() {
            (now.0 - self.since.0).max(0.0)
        } else {
            0.0
        };
        let speed = match self.steering.is_hurried {
            true => SPEED * HURRY,
            false => SPEED,
        };
        let way = self.steering.towards() * (seconds * speed * self.scene.1);
        self.go(way, head);
        (self.steering, self.since) = (steering, now);
    }

    /// One step along a direction of the head.
    pub(super) fn step(&mut self, towards: [f64; 3], head: (&Axes, &Field)) {
        let towards = DVec3::from_array(towards).normalize_or_zero();
        self.go(towards * (STEP.0 * SPEED * self.scene.1), head);
    }

    /// Ahead until what was in the middle of the scene is closer by this factor, or away from it.
    pub(super) fn come_closer(&mut self, factor: f64, head: (&Axes, &Field)) {
        let (centre, radius) = self.scene;
        let distance = (self.place(head.1) - centre).length();
        let ahead = distance.max(LEAST_DISTANCE * radius) * (1.0 - 1.0 / factor.max(1e-3));
        self.go(DVec3::new(0.0, 0.0, ahead), head);
    }

    /// Goes along the right, up and ahead of the head, in metres.
    fn go(&mut self, way: DVec3, (axes, field): (&Axes, &Field)) {
        if way == DVec3::ZERO {
            return;
        }
        let (centre, radius) = self.scene;
        let way = axes.right * way.x - axes.down * way.y + axes.forward * way.z;
        let from_centre = self.place(field) + way - centre;
        self.place = Some(centre + from_centre.clamp_length_max(FARTHEST * radius));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::navigation::{Navigation, Pane};
    use crate::view::route::Route;
    use crate::view::surface::Screen;
    use proptest::prelude::*;

    const SCENE: (DVec3, f64) = (DVec3::new(1.0, 2.0, 3.0), 4.0);
    const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];
    const RIGHT: [f64; 3] = [1.0, 0.0, 0.0];
    const UP: [f64; 3] = [0.0, 1.0, 0.0];

    fn pane() -> Pane {
        Pane::new([1600, 1000], [1920, 1080], Screen::default())
    }

    fn flying() -> Navigation {
        Navigation::through(SCENE, Radians(0.0), Radians::from_degrees(100.0))
    }

    fn place(eye: &Navigation) -> DVec3 {
        eye.shown(&pane()).view.position
    }

    /// Flies along `towards` for this long, looked at after each part of it.
    fn flown(towards: [f64; 3], seconds: f64, parts: u32) -> Navigation {
        let mut eye = flying();
        eye.steer(
            Steering::default().with(towards, true),
            &pane(),
            Seconds(7.0),
        );
        for part in 1..=parts {
            let now = Seconds(7.0 + seconds * f64::from(part) / f64::from(parts));
            eye.fly_on(&pane(), now);
        }
        eye
    }

    #[test]
    fn a_viewer_of_a_scene_begins_where_one_who_stands_still_is() {
        let eye = flying();
        let shown = eye.shown(&pane());
        let still = Route::Still.pose(Seconds(0.0), SCENE, &shown.view.field);
        assert_eq!(shown.view.position, still.position);
        assert_eq!((shown.view.axes, shown.origin), (Axes::FRONT, [0, 0]));
        assert_eq!(shown.view.size, pane().size);
        // A window that becomes higher before anybody moved still shows all of it.
        let high = Pane::new([500, 1000], [1920, 1080], Screen::default());
        let view = eye.shown(&high).view;
        let (centre, radius) = SCENE;
        let reach = libm::tan(libm::asin(radius / view.position.distance(centre)));
        let field = view.field;
        let least = field.left.min(field.right).min(field.up).min(field.down);
        assert!((reach - 0.8 * least).abs() < 1e-9, "{reach} of {least}");
    }

    #[test]
    fn a_flat_scene_is_seen_from_above_at_first_and_after_a_reset() {
        let rise = Radians(0.6);
        let mut eye = Navigation::through(SCENE, rise, Radians::from_degrees(100.0));
        let start = eye.shown(&pane()).view;
        let (centre, radius) = SCENE;
        let towards = (centre - start.position).normalize();
        assert!(start.axes.forward.distance(towards) < 1e-12);
        assert!((towards.y + libm::sin(rise.0)).abs() < 1e-12);
        let still = place(&flying()).distance(centre);
        assert!((start.position.distance(centre) - still).abs() < 1e-9 * radius);
        eye.drag([80.0, 30.0], &pane());
        eye.step(AHEAD, &pane());
        assert_ne!(eye.shown(&pane()).view, start);
        eye.reset();
        assert_eq!(eye.shown(&pane()).view, start);
    }

    #[test]
    fn who_flies_twice_as_long_comes_twice_as_far_however_often_it_is_looked_at() {
        let start = place(&flying());
        let one = place(&flown(AHEAD, 1.0, 1)) - start;
        assert!((one - DVec3::new(0.0, 0.0, -SPEED * SCENE.1)).length() < 1e-9);
        for parts in [1, 7, 240] {
            let two = place(&flown(AHEAD, 2.0, parts)) - start;
            assert!((two - 2.0 * one).length() < 1e-9, "{parts}: {two}");
        }
        let right = place(&flown(RIGHT, 1.0, 3)) - start;
        assert!((right - DVec3::new(SPEED * SCENE.1, 0.0, 0.0)).length() < 1e-9);
        let up = place(&flown(UP, 1.0, 3)) - start;
        assert!((up - DVec3::new(0.0, SPEED * SCENE.1, 0.0)).length() < 1e-9);
    }

    #[test]
    fn a_key_that_is_let_go_ends_the_flight_and_two_that_are_opposite_cancel_out() {
        let mut eye = flown(AHEAD, 1.0, 4);
        let there = place(&eye);
        assert!(eye.is_under_way());
        eye.steer(Steering::default(), &pane(), Seconds(8.0));
        eye.fly_on(&pane(), Seconds(99.0));
        assert_eq!(place(&eye), there);
        assert!(!eye.is_under_way());
        let both = Steering::default()
            .with(AHEAD, true)
            .with([0.0, 0.0, -1.0], true);
        assert!(!both.goes() && both.with(AHEAD, false).goes());
    }

    #[test]
    fn a_hurry_is_faster_and_two_directions_together_are_not() {
        let start = place(&flying());
        let usual = place(&flown(AHEAD, 0.5, 1)) - start;
        let mut eye = flying();
        let steering = Steering::default().with(AHEAD, true).hurried(true);
        eye.steer(steering, &pane(), Seconds(0.0));
        eye.fly_on(&pane(), Seconds(0.5));
        assert!((place(&eye) - start - HURRY * usual).length() < 1e-9);
        let across = place(&flown([1.0, 1.0, 1.0], 0.5, 1)) - start;
        assert!((across.length() - usual.length()).abs() < 1e-9);
    }

    #[test]
    fn ahead_is_where_the_head_was_turned_by_hand() {
        let mut eye = flying();
        let start = place(&eye);
        // A quarter turn to the right.
        let quarter = core::f64::consts::FRAC_PI_2;
        eye.look([Some(Radians(quarter)), None, None], &pane());
        eye.step(AHEAD, &pane());
        let way = place(&eye) - start;
        assert!((way - DVec3::new(STEP.0 * SPEED * SCENE.1, 0.0, 0.0)).length() < 1e-9);
        eye.drag([160.0, 0.0], &pane());
        assert!(
            eye.head().yaw.0 < quarter,
            "the scene follows the hand to the right"
        );
        eye.reset();
        assert_eq!(eye, flying());
    }

    #[test]
    fn a_wheel_comes_closer_goes_back_and_goes_on_within_the_scene() {
        let mut eye = flying();
        let from_centre = |eye: &Navigation| (place(eye) - SCENE.0).length();
        let before = from_centre(&eye);
        eye.zoom_by(1.25, [3.0, 4.0], &pane());
        assert!((from_centre(&eye) - before / 1.25).abs() < 1e-9);
        eye.zoom_by(0.8, [700.0, 4.0], &pane());
        assert!((from_centre(&eye) - before).abs() < 1e-9);
        (0..200).for_each(|_| eye.zoom_by(1.25, [0.0; 2], &pane()));
        assert!(
            place(&eye).z < SCENE.0.z - SCENE.1,
            "it comes out on the other side"
        );
        assert_eq!(eye.zoom(), 1.0);
    }

    #[test]
    fn video_is_not_flown_through() {
        let surface = crate::view::surface::Surface::cube(64);
        let sphere = Navigation::new(surface, Radians(1.0));
        let mut eye = sphere;
        eye.steer(Steering::default().with(AHEAD, true), &pane(), Seconds(0.0));
        eye.step(AHEAD, &pane());
        eye.fly_on(&pane(), Seconds(9.0));
        assert_eq!(eye, sphere);
        assert!(!eye.is_under_way());
    }

    proptest! {
        #[test]
        fn any_way_through_a_scene_ends_at_a_place_from_which_it_can_be_found_again(
            steps in prop::collection::vec(
                (-1.0..1.0f64, -900.0..900.0f64, 0.0..1e6f64, 0.01..100.0f64), 1..20,
            ),
        ) {
            let mut eye = flying();
            let mut now = 0.0;
            for (ahead, drag, seconds, factor) in steps {
                let steering = Steering::default().with([ahead, -ahead, ahead], true);
                eye.steer(steering, &pane(), Seconds(now));
                eye.drag([drag, drag / 2.0], &pane());
                now += seconds;
                eye.fly_on(&pane(), Seconds(now));
                eye.zoom_by(factor, [0.0; 2], &pane());
                let shown = eye.shown(&pane());
                prop_assert!(shown.view.field.is_open());
                let away = (shown.view.position - SCENE.0).length();
                prop_assert!(away <= FARTHEST * SCENE.1 * (1.0 + 1e-9), "{away}");
            }
        }
    }
}
