//! Where on a source's picture does a pixel of a view look, and how densely?

use crate::prepare::Surround;
use crate::sphere::Coverage;
use foveal_core::view::eye_view::EyeView;
use foveal_core::view::surface::{CUBE_FACES, Surface, cube_face};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// What a pixel of a view looks at.
pub(super) struct Spot {
    pub(super) face: usize,
    /// In pixels of the source, from the left and top border.
    pub(super) place: [f64; 2],
    /// Pixels of the source, along its columns and rows, to a pixel of the view.
    pub(super) stretch: [f64; 2],
}

/// The way from the pixels of a view to those of a source.
pub(super) struct Chart {
    surround: Surround,
    /// Of the source: the rectangle of flat content, the faces of a cube.
    surface: Surface,
    /// Pixels of one eye's picture, or of a face.
    size: [u32; 2],
    /// Turns (column, row, 1) into a homogeneous place on flat content, else into a ray.
    content_from_pixel: DMat3,
}

/// Longest arc round a pole, in radians, that counts as a pixel: beyond it a row of the source
/// bends away from the pixel's own.
const LONGEST_ARC: f64 = 0.5;

impl Chart {
    pub(super) fn new(
        surround: Surround,
        surface: Surface,
        size: [u32; 2],
        view: &EyeView,
    ) -> Self {
        Self {
            surround,
            surface,
            size,
            content_from_pixel: match surround {
                Surround::Flat => view.content_from_pixel(&surface),
                Surround::Equirect(_) | Surround::Cube(_) => view.ray_from_pixel(),
            },
        }
    }

    /// What a place of the view shows; none where the source shows nothing.
    pub(super) fn spot(&self, [x, y]: [f64; 2]) -> Option<Spot> {
        let m = self.content_from_pixel;
        let rays = [m * DVec3::new(x, y, 1.0), m.x_axis, m.y_axis];
        let spot = match self.surround {
            Surround::Flat => projected(0, rays)?,
            Surround::Cube(_) => self.on_cube(rays)?,
            Surround::Equirect(coverage) => self.on_sphere(coverage, rays),
        };
        let inside = (0..2).all(|k| (0.0..f64::from(self.size[k])).contains(&spot.place[k]));
        inside.then_some(spot)
    }

    /// The place on a face of a cube, from a ray and its changes to the right and down.
    fn on_cube(&self, rays: [DVec3; 3]) -> Option<Spot> {
        let face = cube_face(rays[0]);
        if face >= self.surface.faces_of_an_eye() {
            return None;
        }
        let axes = CUBE_FACES[face as usize];
        let half = f64::from(self.size[0]) / 2.0;
        let homogeneous = |ray: DVec3| {
            let depth = ray.dot(axes.forward);
            let across = DVec2::new(ray.dot(axes.right), ray.dot(axes.down));
            (half * (across + depth)).extend(depth)
        };
        // Rounding may put the border of a face beyond it.
        let mut spot = projected(face as usize, rays.map(homogeneous))?;
        let last = f64::from(self.size[0]) * (1.0 - f64::EPSILON);
        spot.place = spot.place.map(|place| place.clamp(0.0, last));
        Some(spot)
    }

    /// The place on an equirectangular picture, from a ray and its changes to the right and down.
    fn on_sphere(&self, coverage: Coverage, [ray, right, down]: [DVec3; 3]) -> Spot {
        let [w, h] = self.size.map(f64::from);
        let turn = match coverage {
            Coverage::Full => w,
            Coverage::FrontHalf => 2.0 * w,
        };
        let [per_yaw, per_pitch] = [turn / TAU, h / PI];
        let level = ray.x.hypot(ray.z).max(f64::MIN_POSITIVE);
        let yaw = libm::atan2(ray.x, -ray.z);
        let pitch = libm::atan2(ray.y, level);
        let yaw_by = |d: DVec3| (ray.x * d.z - ray.z * d.x) / (level * level);
        let pitch_by = |d: DVec3| {
            let level_by = (ray.x * d.x + ray.z * d.z) / level;
            (d.y * level - ray.y * level_by) / ray.length_squared()
        };
        let arc = yaw_by(right).hypot(yaw_by(down)).min(LONGEST_ARC);
        // A whole turn to the right is where it began.
        let column = w / 2.0 + yaw * per_yaw;
        let column = if column >= turn {
            column - turn
        } else {
            column
        };
        Spot {
            face: 0,
            place: [
                column,
                (h / 2.0 - pitch * per_pitch).min(h * (1.0 - f64::EPSILON)),
            ],
            stretch: [
                arc * per_yaw,
                pitch_by(right).hypot(pitch_by(down)) * per_pitch,
            ],
        }
    }

    /// The neighbouring face and the place on it, for a place beyond the border of a cube's face.
    pub(super) fn beyond(&self, face: usize, place: [f64; 2]) -> Option<(usize, [f64; 2])> {
        if !matches!(self.surround, Surround::Cube(_)) {
            return None;
        }
        let direction = self.surface.direction(face as u32, place);
        let (beside, place) = self.surface.locate(direction)?;
        (beside as usize != face).then_some((beside as usize, place))
    }

    /// The sample in the place of one beyond the border: a turn closes, and over a pole lies the
    /// other side; else the border goes on.
    pub(super) fn folded(&self, [mut x, mut y]: [i64; 2], [w, h]: [i64; 2]) -> [i64; 2] {
        if self.surround == Surround::Equirect(Coverage::Full) {
            if !(0..h).contains(&y) {
                y = if y < 0 { -1 - y } else { 2 * h - 1 - y };
                x += w / 2;
            }
            x = x.rem_euclid(w);
        }
        [x.clamp(0, w - 1), y.clamp(0, h - 1)]
    }
}

/// The place that a homogeneous one stands for, and how it changes with that; none behind.
fn projected(face: usize, [at, right, down]: [DVec3; 3]) -> Option<Spot> {
    if at.z <= 0.0 {
        return None;
    }
    let place = at.truncate() / at.z;
    let by = |d: DVec3| (d.truncate() - place * d.z) / at.z;
    let [right, down] = [by(right), by(down)];
    Some(Spot {
        face,
        place: place.to_array(),
        stretch: [right.x.hypot(down.x), right.y.hypot(down.y)],
    })
}
