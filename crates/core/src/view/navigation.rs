//! What part of the content does a window or a page show?
//!
//! Zooming and turning change the content under a degree, never the eye: the window fills the same
//! angles there as long as it keeps its pixels.

use crate::units::Radians;
use crate::view::axes::Axes;
use crate::view::eye_view::{EyeView, Field};
use crate::view::head_pose::HeadPose;
use crate::view::surface::{Eye, Projection, Screen, Surface};
use glam::DVec3;

/// Display pixels over one pixel of the content at the closest.
const CLOSEST: f64 = 32.0;
/// A head does not look steeper than this, in degrees.
const STEEPEST_DEG: f64 = 89.0;
/// Half the widest field of view, in degrees.
const WIDEST_HALF_DEG: f64 = 70.0;

/// Where the viewer has gone in the content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Navigation {
    surface: Surface,
    /// Half the larger side of a sphere's view at unit distance, before zooming.
    tangent: f64,
    /// The yaw that a sphere's view begins at.
    front: Radians,
    /// Where the viewer turned the head by hand.
    head: HeadPose,
    /// Where the head is turned to by whatever else moves it; the hand adds to that.
    led: Option<HeadPose>,
    zoom: f64,
    /// Flat content: the place in the window's centre, in level-0 pixels.
    centre: [f64; 2],
}

/// What of the window is picture, and what it shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// What is seen of the content.
    pub view: EyeView,
    /// Left and top of the picture in the window, in pixels.
    pub origin: [u32; 2],
}

impl Shown {
    /// A place in the window as one in the picture.
    pub fn in_picture(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| place[k] - f64::from(self.origin[k]))
    }
}

/// A window, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pane {
    /// Columns and rows of pixels; at least 1.
    pub size: [u32; 2],
    /// A pixel's side at unit distance from the eye.
    pub pitch_at_eye: f64,
}

impl Pane {
    /// A window of `size` pixels on a screen of `screen_size` pixels.
    pub fn new(size: [u32; 2], screen_size: [u32; 2], screen: Screen) -> Self {
        let [w, h] = screen_size.map(f64::from);
        let diagonal = screen.diagonal_inches * 0.0254 / screen.distance_m;
        Self {
            size: size.map(|side| side.max(1)),
            pitch_at_eye: diagonal / libm::hypot(w, h).max(1.0),
        }
    }

    /// One of `count` equal parts of it, side by side.
    pub fn part(&self, count: usize) -> Self {
        let [w, h] = self.size;
        Self {
            size: [(w / count.max(1) as u32).max(1), h],
            ..*self
        }
    }

    /// Pixels of the longer side, which a sphere's field of view is measured along.
    fn larger_side(&self) -> f64 {
        f64::from(self.size[0].max(self.size[1]))
    }

    /// Tangents at the eye, before the window's centre, of a picture that begins at `origin`.
    fn at_eye(&self, origin: [u32; 2], size: [u32; 2]) -> [f64; 4] {
        let from = |k: usize| f64::from(self.size[k]) / 2.0 - f64::from(origin[k]);
        let to = |k: usize| f64::from(size[k]) - from(k);
        [from(0), to(0), from(1), to(1)].map(|pixels| pixels * self.pitch_at_eye)
    }
}

impl Navigation {
    /// The whole of flat content, or a sphere's forward in a view whose larger side is `fov` wide.
    pub fn new(surface: Surface, fov: Radians) -> Self {
        Self {
            surface,
            tangent: libm::tan(fov.0 / 2.0),
            front: Radians(0.0),
            head: HeadPose::default(),
            led: None,
            zoom: 1.0,
            centre: surface.size.map(|side| f64::from(side) / 2.0),
        }
    }

    /// The same, but for a sphere's view that begins at another yaw.
    #[must_use]
    pub fn facing(mut self, front: Radians) -> Self {
        if self.surface.projection == Projection::Cube {
            self.front = within_a_turn(front.0);
            self.head.yaw = self.front;
        }
        self
    }

    /// Back to the beginning.
    pub fn reset(&mut self) {
        self.head = HeadPose {
            yaw: self.front,
            ..HeadPose::default()
        };
        self.zoom = 1.0;
        self.centre = self.surface.size.map(|side| f64::from(side) / 2.0);
    }

    /// Turns a sphere's view by hand to a yaw and a pitch, and zooms until it is `fov` wide, as far
    /// as it may; what is `None` stays. Flat content has no directions and stays as it is.
    pub fn look(&mut self, [yaw, pitch, fov]: [Option<Radians>; 3], pane: &Pane) {
        if self.surface.projection == Projection::Flat {
            return;
        }
        let steepest = Radians::from_degrees(STEEPEST_DEG).0;
        if let Some(yaw) = yaw {
            self.head.yaw = within_a_turn(yaw.0);
        }
        if let Some(pitch) = pitch {
            self.head.pitch = Radians(pitch.0.clamp(-steepest, steepest));
        }
        if let Some(fov) = fov {
            let middle = pane.size.map(|side| f64::from(side) / 2.0);
            let wanted = self.tangent / libm::tan(fov.0 / 2.0);
            self.zoom_by(wanted / self.zoom, middle, pane);
        }
    }

    /// How wide a sphere's view is; before zooming it is what it began with.
    pub fn field(&self) -> Radians {
        Radians(2.0 * libm::atan(self.tangent / self.zoom))
    }

    /// Where the head is turned to.
    pub fn head(&self) -> HeadPose {
        let Some(led) = self.led else {
            return self.head;
        };
        let steepest = Radians::from_degrees(STEEPEST_DEG).0;
        let pitch = led.pitch.0 + self.head.pitch.0;
        HeadPose {
            yaw: Radians(led.yaw.0 + self.head.yaw.0),
            pitch: Radians(pitch.clamp(-steepest, steepest)),
            roll: led.roll,
        }
    }

    /// Turns the head, where there is a sphere to look around in; what the hand turned stays.
    pub fn look_along(&mut self, head: HeadPose) {
        if self.surface.projection != Projection::Flat {
            self.led = Some(head);
        }
    }

    /// A gaze of whoever is led, with the head turned on by hand: the eye stays in the head.
    pub fn with_the_hand(&self, gaze_in_content: DVec3) -> DVec3 {
        match self.led {
            Some(led) if self.head != HeadPose::default() => {
                let (from, to) = (led.axes(), self.head().axes());
                let part = |axis: DVec3| gaze_in_content.dot(axis);
                to.right * part(from.right)
                    + to.down * part(from.down)
                    + to.forward * part(from.forward)
            }
            _ => gaze_in_content,
        }
    }

    /// How much closer it is than at the beginning.
    pub fn zoom(&self) -> f64 {
        self.zoom
    }

    /// Draws the content along by this many pixels of the window.
    pub fn drag(&mut self, [x, y]: [f64; 2], pane: &Pane) {
        match self.surface.projection {
            Projection::Flat => {
                let scale = self.scale(pane);
                self.centre = [self.centre[0] - x / scale, self.centre[1] - y / scale];
                self.keep_inside(pane);
            }
            Projection::Cube => {
                let per_pixel = 2.0 * self.tangent / self.zoom / pane.larger_side();
                let steepest = Radians::from_degrees(STEEPEST_DEG).0;
                self.head.yaw = within_a_turn(self.head.yaw.0 - x * per_pixel);
                let pitch = self.head.pitch.0 + y * per_pixel;
                self.head.pitch = Radians(pitch.clamp(-steepest, steepest));
            }
        }
    }

    /// Comes closer by `factor`; what flat content shows at `place` of the window stays there.
    pub fn zoom_by(&mut self, factor: f64, place: [f64; 2], pane: &Pane) {
        let before = self.scale(pane);
        let whole = before / self.zoom;
        let widest = match self.surface.projection {
            Projection::Flat => 1.0,
            Projection::Cube => self.tangent / libm::tan(Radians::from_degrees(WIDEST_HALF_DEG).0),
        };
        let widest = widest.min(1.0);
        self.zoom = (self.zoom * factor).clamp(widest, (CLOSEST / whole).max(1.0));
        let after = self.scale(pane);
        let off = [0, 1].map(|k| place[k] - f64::from(pane.size[k]) / 2.0);
        self.centre = [0, 1].map(|k| self.centre[k] + off[k] / before - off[k] / after);
        self.keep_inside(pane);
    }

    /// Display pixels over one pixel of the content, in the middle of the view.
    pub fn scale(&self, pane: &Pane) -> f64 {
        self.zoom
            * match self.surface.projection {
                Projection::Flat => {
                    let [w, h] = pane.size.map(f64::from);
                    let [content_w, content_h] = self.surface.size.map(f64::from);
                    (w / content_w).min(h / content_h)
                }
                Projection::Cube => {
                    self.surface.pitch() * pane.larger_side() / (2.0 * self.tangent)
                }
            }
    }

    /// What the window shows.
    pub fn shown(&self, pane: &Pane) -> Shown {
        match self.surface.projection {
            Projection::Flat => self.flat(pane),
            Projection::Cube => {
                let field = Field {
                    at_eye: Some(pane.at_eye([0, 0], pane.size)),
                    ..Field::reaching(self.tangent / self.zoom, pane.size)
                };
                let view = EyeView {
                    position: Default::default(),
                    axes: self.head().axes(),
                    field,
                    size: pane.size,
                    eye: Eye::Left,
                };
                Shown {
                    view,
                    origin: [0, 0],
                }
            }
        }
    }

    /// The part of the window that content covers, and the part of the content that it shows.
    fn flat(&self, pane: &Pane) -> Shown {
        let scale = self.scale(pane);
        let mut origin = [0; 2];
        let mut size = [1; 2];
        let mut tangents = [[0.0; 2]; 2];
        for k in 0..2 {
            let side = f64::from(self.surface.size[k]);
            let from = f64::from(pane.size[k]) / 2.0 - self.centre[k] * scale;
            let [begin, end] = [from, from + side * scale]
                .map(|edge| edge.round().clamp(0.0, f64::from(pane.size[k])));
            let begin = begin.min(f64::from(pane.size[k]) - 1.0);
            let end = end.max(begin + 1.0);
            origin[k] = begin as u32;
            size[k] = (end - begin) as u32;
            // Whole content fills its pixels exactly, whatever they were rounded to.
            let share = |edge: f64| match self.zoom > 1.0 {
                true => (edge - from) / (side * scale),
                false => (edge - begin) / (end - begin),
            };
            tangents[k] = [begin, end].map(|e| (share(e) * 2.0 - 1.0) * self.surface.tangents[k]);
        }
        let [[left, right], [up, down]] = tangents;
        let field = Field {
            at_eye: Some(pane.at_eye(origin, size)),
            ..Field::of([-left, right, -up, down])
        };
        let view = EyeView {
            position: Default::default(),
            axes: Axes::FRONT,
            field,
            size,
            eye: Eye::Left,
        };
        Shown { view, origin }
    }

    /// Keeps flat content over the window, or in its middle where it is smaller.
    fn keep_inside(&mut self, pane: &Pane) {
        let scale = self.scale(pane);
        for k in 0..2 {
            let side = f64::from(self.surface.size[k]);
            let half = f64::from(pane.size[k]) / 2.0 / scale;
            self.centre[k] = if half * 2.0 >= side {
                side / 2.0
            } else {
                self.centre[k].clamp(half, side - half)
            };
        }
    }
}

/// The same direction within half a turn to either side.
fn within_a_turn(yaw: f64) -> Radians {
    let turn = std::f64::consts::TAU;
    Radians((yaw + turn / 2.0).rem_euclid(turn) - turn / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pane(size: [u32; 2]) -> Pane {
        Pane::new(size, [1920, 1080], Screen::default())
    }

    fn flat(size: [u32; 2]) -> Navigation {
        Navigation::new(Surface::flat(size, Screen::default()), Radians(1.0))
    }

    fn content_at(scene: &Navigation, pane: &Pane, place: [f64; 2]) -> [f64; 2] {
        let shown = scene.shown(pane);
        let ray = shown.view.ray(shown.in_picture(place));
        scene.surface.locate(ray).unwrap().1
    }

    #[test]
    fn whole_flat_content_is_the_view_that_it_fills() {
        let scene = flat([1920, 1080]);
        let shown = scene.shown(&pane([960, 540]));
        let filling = EyeView::filling(&scene.surface, [960, 540]);
        assert_eq!(shown.origin, [0, 0]);
        assert_eq!(
            Field {
                at_eye: None,
                ..shown.view.field
            },
            filling.field
        );
        let boxed = scene.shown(&pane([960, 740]));
        assert_eq!((boxed.origin, boxed.view.size), ([0, 100], [960, 540]));
        assert_eq!(
            Field {
                at_eye: None,
                ..boxed.view.field
            },
            filling.field
        );
    }

    #[test]
    fn a_window_fills_the_same_angle_at_the_eye_however_far_it_is_zoomed() {
        let mut scene = Navigation::new(Surface::cube(4096), Radians::from_degrees(100.0));
        let pane = pane([1920, 1080]);
        let before = scene.shown(&pane).view;
        scene.zoom_by(20.0, [0.0, 0.0], &pane);
        let after = scene.shown(&pane).view;
        assert_eq!(before.field.at_eye, after.field.at_eye);
        assert!(after.field.left < before.field.left / 19.0);
        // 24 inches at 0.6 m, 16:9: 47.7° across.
        let across = before.as_seen().field.left.atan() * 2.0;
        assert!((across.to_degrees() - 47.77).abs() < 0.1);
    }

    #[test]
    fn a_window_held_upright_shows_the_same_angle_along_its_longer_side() {
        let mut scene = Navigation::new(Surface::cube(4096), Radians::from_degrees(100.0));
        let (upright, lying) = (pane([360, 640]), pane([640, 360]));
        let [tall, wide] = [upright, lying].map(|pane| scene.shown(&pane).view.field);
        assert_eq!((tall.up, tall.left), (wide.left, wide.up));
        assert!((tall.up.atan().to_degrees() - 50.0).abs() < 1e-9);
        assert_eq!(scene.scale(&upright), scene.scale(&lying));
        // A hand draws along what is under it, however the window is held.
        scene.drag([0.0, 1.0], &upright);
        scene.drag([0.0, -1.0], &lying);
        assert!(scene.head().pitch.0.abs() < 1e-15);
    }

    #[test]
    fn the_wheel_ends_where_one_pixel_is_thirty_two() {
        let mut scene = flat([16_384, 8192]);
        let pane = pane([1280, 800]);
        (0..200).for_each(|_| scene.zoom_by(1.25, [100.0, 700.0], &pane));
        assert!((scene.scale(&pane) - CLOSEST).abs() < 1e-9);
        (0..200).for_each(|_| scene.zoom_by(0.8, [100.0, 700.0], &pane));
        assert_eq!(scene.shown(&pane), flat([16_384, 8192]).shown(&pane));
    }

    #[test]
    fn dragging_a_sphere_turns_the_head_against_the_hand_and_never_over_the_top() {
        let mut scene = Navigation::new(Surface::cube(1024), Radians::from_degrees(90.0));
        let pane = pane([1000, 1000]);
        scene.drag([10.0, 0.0], &pane);
        assert!((scene.head().yaw.0 + 0.02).abs() < 1e-12);
        scene.drag([0.0, 1e6], &pane);
        assert!((scene.head().pitch.to_degrees() - STEEPEST_DEG).abs() < 1e-9);
    }

    #[test]
    fn a_view_that_was_told_is_found_again_by_what_is_told_of_it() {
        let mut scene = Navigation::new(Surface::cube(1024), Radians::from_degrees(100.0));
        let pane = pane([1000, 600]);
        assert!((scene.field().to_degrees() - 100.0).abs() < 1e-9);
        let degrees = |degrees: f64| Some(Radians::from_degrees(degrees));
        scene.look([degrees(-350.0), degrees(20.0), degrees(60.0)], &pane);
        assert!((scene.head().yaw.to_degrees() - 10.0).abs() < 1e-9);
        assert!((scene.head().pitch.to_degrees() - 20.0).abs() < 1e-9);
        assert!((scene.field().to_degrees() - 60.0).abs() < 1e-9);
        let across = scene.shown(&pane).view.field.left.atan() * 2.0;
        assert!((across.to_degrees() - 60.0).abs() < 1e-9);
        scene.look([None, degrees(-90.0), None], &pane);
        assert!((scene.head().pitch.to_degrees() + STEEPEST_DEG).abs() < 1e-9);
        assert!((scene.field().to_degrees() - 60.0).abs() < 1e-9);
        // Wider and closer than may be is as wide and as close as may be.
        scene.look([None, None, degrees(170.0)], &pane);
        assert!((scene.field().to_degrees() - 2.0 * WIDEST_HALF_DEG).abs() < 1e-9);
        scene.look([None, None, degrees(1e-3)], &pane);
        assert!((scene.scale(&pane) - CLOSEST).abs() < 1e-6);
        let mut plane = flat([640, 360]);
        plane.look([degrees(10.0), degrees(10.0), degrees(10.0)], &pane);
        assert_eq!(plane, flat([640, 360]));
    }

    #[test]
    fn a_view_begins_at_its_front_and_goes_back_there() {
        let pane = pane([1000, 600]);
        let sphere = Navigation::new(Surface::cube(1024), Radians::from_degrees(100.0));
        let mut scene = sphere.facing(Radians::from_degrees(200.0));
        assert!((scene.head().yaw.to_degrees() + 160.0).abs() < 1e-9);
        let begun = scene;
        scene.drag([30.0, 40.0], &pane);
        assert_ne!(scene, begun);
        scene.reset();
        assert_eq!(scene, begun);
        let plane = flat([640, 360]);
        assert_eq!(plane.facing(Radians(1.0)), plane);
    }

    #[test]
    fn a_hand_turns_a_led_head_on_and_takes_the_gaze_along() {
        let mut scene = Navigation::new(Surface::cube(1024), Radians::from_degrees(90.0));
        let pane = pane([1000, 1000]);
        let led = HeadPose {
            yaw: Radians(0.5),
            pitch: Radians(0.2),
            roll: Radians(0.1),
        };
        scene.look_along(led);
        let gaze = scene.shown(&pane).view.ray([300.0, 700.0]).normalize();
        assert_eq!(scene.with_the_hand(gaze), gaze);
        scene.drag([-50.0, 20.0], &pane);
        scene.look_along(led);
        assert!((scene.head().yaw.0 - 0.6).abs() < 1e-12);
        assert!((scene.head().pitch.0 - 0.24).abs() < 1e-12);
        let place = scene
            .shown(&pane)
            .view
            .place(scene.with_the_hand(gaze))
            .unwrap();
        assert!((place[0] - 300.0).abs() < 1e-6 && (place[1] - 700.0).abs() < 1e-6);
        scene.reset();
        assert_eq!(scene.head(), led);
    }

    proptest! {
        #[test]
        fn any_way_through_flat_content_stays_on_it(
            steps in prop::collection::vec(
                (-500.0..500.0f64, -500.0..500.0f64, 0.5..2.0f64), 1..20,
            ),
            size in (1u32..3000, 1u32..3000),
            window in (1u32..2000, 1u32..2000),
        ) {
            let mut scene = flat([size.0, size.1]);
            let pane = pane([window.0, window.1]);
            for (x, y, factor) in steps {
                scene.zoom_by(factor, [x.abs(), y.abs()], &pane);
                scene.drag([x, y], &pane);
                let shown = scene.shown(&pane);
                prop_assert!(shown.view.field.is_open(), "{shown:?}");
                for k in 0..2 {
                    prop_assert!(shown.origin[k] + shown.view.size[k] <= pane.size[k]);
                }
            }
        }

        #[test]
        fn what_is_under_the_cursor_stays_there(
            x in 300.0..900.0f64, y in 300.0..500.0f64, factor in 1.0..5.0f64,
        ) {
            let mut scene = flat([4000, 2500]);
            let pane = pane([1280, 800]);
            scene.zoom_by(4.0, [640.0, 400.0], &pane);
            let before = content_at(&scene, &pane, [x, y]);
            scene.zoom_by(factor, [x, y], &pane);
            let after = content_at(&scene, &pane, [x, y]);
            for k in 0..2 {
                prop_assert!((before[k] - after[k]).abs() < 1e-6, "{before:?} {after:?}");
            }
        }
    }
}
