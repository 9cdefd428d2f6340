//! Where before the eyes does the source lie, and which of its places lies in a direction?

use crate::view::axes::Axes;
use core::f64::consts::PI;
use glam::{DMat3, DVec3};

/// How the columns and rows of a source lie over directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SourceProjection {
    /// Evenly in tangents, as a camera draws: a screen.
    #[default]
    Plane,
    /// Columns evenly in azimuth, rows in the tangent of the elevation.
    Cylinder,
    /// Columns evenly in azimuth, rows in elevation.
    Equirect,
    /// Evenly in the angle from the axis, in every direction from it.
    Fisheye,
}

/// A source before the eyes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// How it is drawn.
    pub projection: SourceProjection,
    /// Where its middle and its right lie; its window may be off the middle.
    pub axes: Axes,
    /// How far it reaches from the axis: left, right, up, down, outward; in tangents, radians of
    /// azimuth or elevation, as its projection has them.
    pub window: [f64; 4],
    /// The eye's place in distances from the head's middle to the source: nothing where the source
    /// is infinitely far.
    pub eye: DVec3,
}

/// A place in a source and how it moves with what looks at it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourcePlace {
    /// Column and row, in pixels.
    pub place: [f64; 2],
    /// Rows: the change of the column, and of the row.
    pub change: [DVec3; 2],
}

impl Placement {
    /// A source that is infinitely far.
    #[must_use]
    pub fn new(projection: SourceProjection, axes: Axes, window: [f64; 4]) -> Self {
        Self {
            projection,
            axes,
            window,
            eye: DVec3::ZERO,
        }
    }

    /// The same at `distance` metres before a head whose eye is at `eye`, in metres.
    #[must_use]
    pub fn seen_from(self, eye: DVec3, distance: f64) -> Self {
        Self {
            eye: eye / distance,
            ..self
        }
    }

    /// Width and height of the window, in its own units.
    #[must_use]
    pub fn extent(&self) -> [f64; 2] {
        let [left, right, up, down] = self.window;
        [left + right, up + down]
    }

    /// The place in a source of `size` pixels, of a ray of any length from the eye; `None` behind a
    /// plane, or where the projection has no place for it. It may lie outside the source.
    ///
    /// ```
    /// use foveal_core::view::axes::Axes;
    /// use foveal_core::view::panel::placement::{Placement, SourceProjection};
    /// use glam::DVec3;
    ///
    /// let plane = Placement::new(SourceProjection::Plane, Axes::FRONT, [1.0, 1.0, 0.5, 0.5]);
    /// let place = plane.source_from_ray(DVec3::new(0.5, 0.0, -1.0), [800, 400]);
    /// assert_eq!(place, Some([600.0, 200.0]));
    /// ```
    #[must_use]
    pub fn source_from_ray(&self, ray: DVec3, size: [u32; 2]) -> Option<[f64; 2]> {
        self.place_of(ray, size).map(|found| found.place)
    }

    /// The same with its change along the ray's components.
    #[must_use]
    pub fn place_of(&self, ray: DVec3, size: [u32; 2]) -> Option<SourcePlace> {
        let found = self.coordinates(ray)?;
        let first = [self.window[0], self.window[2]];
        let extent = self.extent();
        let scale = [0, 1].map(|k| f64::from(size[k]) / extent[k]);
        Some(SourcePlace {
            place: [0, 1].map(|k| (found.place[k] + first[k]) * scale[k]),
            change: [0, 1].map(|k| found.change[k] * scale[k]),
        })
    }

    /// The same in the window's own units, to the right and down of the axis.
    #[must_use]
    pub fn coordinates(&self, ray: DVec3) -> Option<SourcePlace> {
        if self.eye == DVec3::ZERO {
            return self.unmoved(ray);
        }
        let (moved, change) = self.met(ray)?;
        let found = self.unmoved(moved)?;
        Some(SourcePlace {
            place: found.place,
            change: found.change.map(|row| change.transpose() * row),
        })
    }

    /// Where the eye's ray meets the source, from the head's middle: a plane at distance 1 along
    /// the axis, or a sphere of radius 1; with its change.
    #[must_use]
    pub fn met(&self, ray: DVec3) -> Option<(DVec3, DMat3)> {
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let eye = self.eye;
        if self.projection == SourceProjection::Plane {
            // e + t d on the plane, times what makes it a polynomial.
            let forward = self.axes.forward;
            let left = 1.0 - eye.dot(forward);
            let moved = eye * ray.dot(forward) + ray * left;
            return Some((
                moved,
                outer(eye, forward) + DMat3::from_diagonal(DVec3::splat(left)),
            ));
        }
        let length = ray.length();
        let unit = ray / length;
        let along = eye.dot(unit);
        let root = (1.0 - eye.length_squared() + along * along).sqrt();
        if !(root > 0.0 && length > 0.0) {
            return None;
        }
        let far = root - along;
        // Change of the unit ray with the ray, and of how far it goes with the unit ray.
        let turned = (DMat3::IDENTITY - outer(unit, unit)) * (1.0 / length);
        let lengthened = eye * (along / root - 1.0);
        let change = (DMat3::from_diagonal(DVec3::splat(far)) + outer(unit, lengthened)) * turned;
        Some((eye + unit * far, change))
    }

    fn unmoved(&self, ray: DVec3) -> Option<SourcePlace> {
        let Axes {
            right,
            down,
            forward,
        } = self.axes;
        let [x, y, z] = [right, down, forward].map(|axis| ray.dot(axis));
        let found = match self.projection {
            SourceProjection::Plane => plane(x, y, z),
            SourceProjection::Cylinder => cylinder(x, y, z),
            SourceProjection::Equirect => equirect(x, y, z),
            SourceProjection::Fisheye => fisheye(x, y, z),
        }?;
        Some(SourcePlace {
            place: found.0,
            change: found.1.map(|[x, y, z]| right * x + down * y + forward * z),
        })
    }

    /// The unit ray, from the head's middle, of a place in a source of `size` pixels; `None` where
    /// the projection has none.
    #[must_use]
    pub fn ray_from_source(&self, place: [f64; 2], size: [u32; 2]) -> Option<DVec3> {
        let extent = self.extent();
        let first = [self.window[0], self.window[2]];
        let [s, t] = [0, 1].map(|k| place[k] / f64::from(size[k]) * extent[k] - first[k]);
        let [x, y, z] = match self.projection {
            SourceProjection::Plane => [s, t, 1.0],
            SourceProjection::Cylinder => [libm::sin(s), t, libm::cos(s)],
            SourceProjection::Equirect => {
                let level = libm::cos(t);
                [libm::sin(s) * level, libm::sin(t), libm::cos(s) * level]
            }
            SourceProjection::Fisheye => {
                let angle = (s * s + t * t).sqrt();
                let share = if angle > 0.0 {
                    libm::sin(angle) / angle
                } else {
                    1.0
                };
                [s * share, t * share, libm::cos(angle)]
            }
        };
        let is_there = match self.projection {
            SourceProjection::Plane => true,
            SourceProjection::Cylinder => s.abs() <= PI,
            SourceProjection::Equirect => s.abs() <= PI && t.abs() <= PI / 2.0,
            SourceProjection::Fisheye => (s * s + t * t).sqrt() <= PI,
        };
        let axes = self.axes;
        let ray = axes.right * x + axes.down * y + axes.forward * z;
        is_there.then(|| ray.normalize())
    }
}

/// Coordinates, and their change with x (right), y (down) and z (forward).
type Found = Option<([f64; 2], [[f64; 3]; 2])>;

fn plane(x: f64, y: f64, z: f64) -> Found {
    let (s, t) = (x / z, y / z);
    (z > 1e-9 * (x.abs() + y.abs()))
        .then_some(([s, t], [[1.0 / z, 0.0, -s / z], [0.0, 1.0 / z, -t / z]]))
}

fn cylinder(x: f64, y: f64, z: f64) -> Found {
    let square = x * x + z * z;
    let level = square.sqrt();
    let t = y / level;
    let azimuth = [z / square, 0.0, -x / square];
    let rise = [-t * x / square, 1.0 / level, -t * z / square];
    (level > 1e-9 * y.abs()).then(|| ([libm::atan2(x, z), t], [azimuth, rise]))
}

fn equirect(x: f64, y: f64, z: f64) -> Found {
    let square = x * x + z * z;
    let level = square.sqrt();
    let all = square + y * y;
    let azimuth = [z / square, 0.0, -x / square];
    let across = y / (level * all);
    let rise = [-x * across, level / all, -z * across];
    (level > 1e-9 * y.abs()).then(|| ([libm::atan2(x, z), libm::atan2(y, level)], [azimuth, rise]))
}

fn fisheye(x: f64, y: f64, z: f64) -> Found {
    let radius = (x * x + y * y).sqrt();
    let all = radius * radius + z * z;
    let angle = libm::atan2(radius, z);
    if radius < 1e-9 * z {
        let z = 1.0 / z;
        return Some(([x * z, y * z], [[z, 0.0, -x * z * z], [0.0, z, -y * z * z]]));
    }
    let (cos, sin) = (x / radius, y / radius);
    // Across the radius a place moves by angle over radius, along it by z over the square.
    let (across, along) = (angle / radius, z / all);
    let mixed = cos * sin * (along - across);
    let back = -radius / all;
    let change = [
        [cos * cos * along + sin * sin * across, mixed, cos * back],
        [mixed, sin * sin * along + cos * cos * across, sin * back],
    ];
    (radius > 0.0).then_some(([angle * cos, angle * sin], change))
}
