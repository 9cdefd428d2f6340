//! What part of the content does a window or a page show?
//!
//! Of a picture before the eye or around it a part; through a scene the eye moves. Zooming and
//! turning change the content under a degree, never the eye: the window fills the same angles there
//! as long as it keeps its pixels.

#[cfg(test)]
mod tests;

use crate::units::{Radians, Seconds};
use crate::view::axes::Axes;
use crate::view::eye_view::{EyeView, Field};
use crate::view::flight::{Flight, Steering};
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
    place: Place,
    /// Half the larger side of a turning view at unit distance, before zooming.
    tangent: f64,
    /// How the head is turned at the beginning: to a sphere's front, or down to a flat scene.
    front: HeadPose,
    /// Where the viewer turned the head by hand.
    head: HeadPose,
    /// Where the head is turned to by whatever else moves it; the hand adds to that.
    led: Option<HeadPose>,
    zoom: f64,
    /// Flat content: the place in the window's centre, in level-0 pixels.
    centre: [f64; 2],
}

/// Where the content is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// A picture on a surface before the eye.
    Before(Surface),
    /// A picture all around.
    Around(Surface),
    /// A scene that the eye is in.
    Through(Flight),
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
        let place = match surface.projection {
            Projection::Flat => Place::Before(surface),
            Projection::Cube | Projection::Equirect => Place::Around(surface),
        };
        Self {
            centre: surface.size.map(|side| f64::from(side) / 2.0),
            ..Self::at(place, fov)
        }
    }

    /// A scene inside a sphere, its middle and its radius in metres: as an eye that stands still
    /// sees it, raised by an angle about its middle, in a view whose larger side is `fov` wide.
    pub fn through(scene: (DVec3, f64), rise: Radians, fov: Radians) -> Self {
        let mut eye = Self::at(Place::Through(Flight::new(scene, rise)), fov);
        eye.front.pitch = Radians(-rise.0);
        eye.head = eye.front;
        eye
    }

    fn at(place: Place, fov: Radians) -> Self {
        Self {
            place,
            tangent: libm::tan(fov.0 / 2.0),
            front: HeadPose::default(),
            head: HeadPose::default(),
            led: None,
            zoom: 1.0,
            centre: [0.0; 2],
        }
    }

    /// The same, but for a sphere's view that begins at another yaw.
    #[must_use]
    pub fn facing(mut self, front: Radians) -> Self {
        if !self.is_flat() {
            self.front.yaw = within_a_turn(front.0);
            self.head.yaw = self.front.yaw;
        }
        self
    }

    /// Back to the beginning.
    pub fn reset(&mut self) {
        self.head = self.front;
        self.zoom = 1.0;
        match &mut self.place {
            Place::Before(surface) | Place::Around(surface) => {
                self.centre = surface.size.map(|side| f64::from(side) / 2.0);
            }
            Place::Through(flight) => flight.reset(),
        }
    }

    fn is_flat(&self) -> bool {
        matches!(self.place, Place::Before(_))
    }

    /// Where a viewer who flies through a scene steers to.
    pub fn steering(&self) -> Steering {
        match &self.place {
            Place::Through(flight) => flight.steering(),
            _ => Steering::default(),
        }
    }

    /// Flies through a scene as it was steered up to now, and as given from here on.
    pub fn steer(&mut self, steering: Steering, pane: &Pane, now: Seconds) {
        let (axes, field) = (self.head().axes(), self.turning_field(pane));
        if let Place::Through(flight) = &mut self.place {
            flight.steer(steering, (&axes, &field), now);
        }
    }

    /// Flies on through a scene as it is steered.
    pub fn fly_on(&mut self, pane: &Pane, now: Seconds) {
        self.steer(self.steering(), pane, now);
    }

    /// Whether what is shown changes by itself: a scene that is flown through.
    pub fn is_under_way(&self) -> bool {
        self.steering().goes()
    }

    /// One step through a scene, to the right, up and ahead of the head, or against these where a
    /// number is negative.
    pub fn step(&mut self, towards: [f64; 3], pane: &Pane) {
        let (axes, field) = (self.head().axes(), self.turning_field(pane));
        if let Place::Through(flight) = &mut self.place {
            flight.step(towards, (&axes, &field));
        }
    }

    /// Turns a view by hand to a yaw and a pitch, and zooms until it is `fov` wide, as far as it
    /// may; what is `None` stays. Flat content has no directions and stays as it is.
    pub fn look(&mut self, [yaw, pitch, fov]: [Option<Radians>; 3], pane: &Pane) {
        if self.is_flat() {
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
            self.magnify(wanted / self.zoom, middle, pane);
        }
    }

    /// How wide a turning view is; before zooming it is what it began with.
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

    /// Turns the head, where there is something to look around in; what the hand turned stays.
    pub fn look_along(&mut self, head: HeadPose) {
        if !self.is_flat() {
            self.led = Some(head);
        }
    }

    /// The gaze of a viewer who is led, with the head turned on by hand: the eye stays in the head.
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
        match &self.place {
            Place::Before(surface) => {
                let (scale, size) = (self.scale(pane), surface.size);
                self.centre = [self.centre[0] - x / scale, self.centre[1] - y / scale];
                self.keep_inside(size, pane);
            }
            Place::Around(_) | Place::Through(_) => {
                let per_pixel = 2.0 * self.tangent / self.zoom / pane.larger_side();
                let steepest = Radians::from_degrees(STEEPEST_DEG).0;
                self.head.yaw = within_a_turn(self.head.yaw.0 - x * per_pixel);
                let pitch = self.head.pitch.0 + y * per_pixel;
                self.head.pitch = Radians(pitch.clamp(-steepest, steepest));
            }
        }
    }

    /// Comes closer by `factor`: in a scene the eye goes ahead; what flat content shows at `place`
    /// of the window stays there.
    pub fn zoom_by(&mut self, factor: f64, place: [f64; 2], pane: &Pane) {
        let (axes, field) = (self.head().axes(), self.turning_field(pane));
        match &mut self.place {
            Place::Through(flight) => flight.come_closer(factor, (&axes, &field)),
            _ => self.magnify(factor, place, pane),
        }
    }

    fn magnify(&mut self, factor: f64, place: [f64; 2], pane: &Pane) {
        let before = self.scale(pane);
        let whole = before / self.zoom;
        let widest = match self.place {
            Place::Before(_) => 1.0,
            _ => self.tangent / libm::tan(Radians::from_degrees(WIDEST_HALF_DEG).0),
        };
        let widest = widest.min(1.0);
        self.zoom = (self.zoom * factor).clamp(widest, (CLOSEST / whole).max(1.0));
        if let Place::Before(Surface { size, .. }) = self.place {
            let after = self.scale(pane);
            let off = [0, 1].map(|k| place[k] - f64::from(pane.size[k]) / 2.0);
            self.centre = [0, 1].map(|k| self.centre[k] + off[k] / before - off[k] / after);
            self.keep_inside(size, pane);
        }
    }

    /// Display pixels over one pixel of the content, in the middle of the view; of a scene, which
    /// has no pixels, how far it is zoomed.
    pub fn scale(&self, pane: &Pane) -> f64 {
        self.zoom
            * match &self.place {
                Place::Before(surface) => {
                    let [w, h] = pane.size.map(f64::from);
                    let [content_w, content_h] = surface.size.map(f64::from);
                    (w / content_w).min(h / content_h)
                }
                Place::Around(surface) => {
                    surface.pitch() * pane.larger_side() / (2.0 * self.tangent)
                }
                Place::Through(_) => 1.0,
            }
    }

    /// What the window shows.
    pub fn shown(&self, pane: &Pane) -> Shown {
        let field = self.turning_field(pane);
        let position = match &self.place {
            Place::Before(surface) => return self.flat(surface, pane),
            Place::Around(_) => DVec3::ZERO,
            Place::Through(flight) => flight.place(&field),
        };
        let view = EyeView {
            position,
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

    /// The field of a view that turns.
    fn turning_field(&self, pane: &Pane) -> Field {
        Field {
            at_eye: Some(pane.at_eye([0, 0], pane.size)),
            ..Field::reaching(self.tangent / self.zoom, pane.size)
        }
    }

    /// The part of the window that content covers, and the part of the content that it shows.
    fn flat(&self, surface: &Surface, pane: &Pane) -> Shown {
        let scale = self.scale(pane);
        let mut origin = [0; 2];
        let mut size = [1; 2];
        let mut tangents = [[0.0; 2]; 2];
        for k in 0..2 {
            let side = f64::from(surface.size[k]);
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
            tangents[k] = [begin, end].map(|e| (share(e) * 2.0 - 1.0) * surface.tangents[k]);
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
    fn keep_inside(&mut self, size: [u32; 2], pane: &Pane) {
        let scale = self.scale(pane);
        for (k, side) in size.map(f64::from).into_iter().enumerate() {
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
