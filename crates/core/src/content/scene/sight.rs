//! How does an eye see a sphere of a scene, and an error in it?
//!
//! An error of a surface is seen at the distance of the nearest point of the sphere round it, and
//! at the least eccentricity that any of its points has. As spheres nest and errors only grow
//! towards the root, what must be refined is then closed: with a unit all that it needs. (Nearly
//! so where a picture fills other angles at the eye than the content: who chooses closes it.)

use crate::perception::glance::Glance;
use crate::perception::spread::SpreadTable;
use crate::units::{Cpd, Ppd, Radians};
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;
use crate::view::frustum::Frustum;
use core::f64::consts::{FRAC_PI_2, PI};
use glam::DVec3;

/// A sphere in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sphere {
    /// Its centre, in metres.
    pub centre: DVec3,
    /// Its radius, in metres.
    pub radius: f64,
}

/// What one view shows a viewer of a scene at one moment.
#[derive(Debug)]
pub struct ViewOfScene {
    pub(super) glance: Glance,
    pub(super) spread: SpreadTable,
    pub(super) frustum: Option<Frustum>,
    pub(super) eye: DVec3,
    /// Pixels of the display at unit distance.
    pub(super) pixels: f64,
}

/// How a sphere and an error in it are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenError {
    /// The error in pixels of the display: what Cesium and Nanite go by.
    pub error_pixels: f64,
    /// The error as an angle at the eye.
    pub error: Radians,
    /// Least eccentricity over the sphere.
    pub eccentricity: Radians,
    /// What the sphere covers at the eye, in square degrees.
    pub area_deg2: f64,
}

/// What of the view is seen of a unit: how much, and how far from the gaze.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenExtent {
    /// In square degrees at the eye.
    pub area_deg2: f64,
    /// Least angle to the gaze.
    pub least: Radians,
    /// Mean angle to the gaze.
    pub mean: Radians,
}

impl ViewOfScene {
    /// What is seen in a glance and up to `margin` outside its view.
    #[must_use]
    pub fn new(glance: &Glance, margin: Radians) -> Self {
        let view = glance.view.as_ref();
        Self {
            glance: *glance,
            spread: SpreadTable::new(glance.gaze.spread),
            frustum: view.map(|view| Frustum::new(view, margin)),
            eye: view.map_or(DVec3::ZERO, |view| view.position),
            pixels: view.map_or(f64::INFINITY, pixels_at_unit_distance),
        }
    }

    /// How a sphere is seen, and an error of a surface in it, in metres; `None` where it is out of
    /// view by more than the margin.
    #[must_use]
    pub fn seen(&self, sphere: &Sphere, error: f64) -> Option<SeenError> {
        let towards = sphere.centre - self.eye;
        let distance = towards.length();
        if distance <= sphere.radius {
            return Some(SeenError {
                error_pixels: f64::INFINITY,
                error: Radians(FRAC_PI_2),
                eccentricity: self.spread.effective(Radians(0.0)),
                area_deg2: 2.0 * PI * Radians(1.0).to_degrees().powi(2),
            });
        }
        let (direction, share) = (towards / distance, sphere.radius / distance);
        let radius = Radians(libm::asin(share));
        let frustum = self.frustum.as_ref();
        if frustum.is_some_and(|it| it.is_missed_by(direction, radius)) {
            return None;
        }
        let nearest = self.nearest(direction, radius);
        let scale = self.eye_scale(nearest);
        let angle = error / (distance - sphere.radius);
        let eccentricity = self.glance.eccentricity(nearest);
        let across = Radians(radius.0 * scale).to_degrees();
        Some(SeenError {
            error_pixels: angle * self.pixels,
            error: Radians(angle * scale),
            eccentricity: self.spread.effective(eccentricity),
            area_deg2: PI * across * across,
        })
    }

    /// What a sphere covers where nothing is before it; nothing where it is out of view by more
    /// than the margin.
    #[must_use]
    pub fn extent(&self, sphere: &Sphere) -> SeenExtent {
        let Some(seen) = self.seen(sphere, 0.0) else {
            return SeenExtent::default();
        };
        let towards = (sphere.centre - self.eye).normalize_or(DVec3::NEG_Z);
        let middle = self.spread.effective(self.glance.eccentricity(towards));
        SeenExtent {
            area_deg2: seen.area_deg2,
            least: seen.eccentricity,
            mean: Radians(middle.0.max(seen.eccentricity.0)),
        }
    }

    /// Pixels a degree of a display in which a length at a place is one pixel, at the eye.
    #[must_use]
    pub fn ppd_of(&self, length: f64, place: &Sphere) -> Ppd {
        let towards = place.centre - self.eye;
        // Within the sphere it may be anywhere in it.
        let distance = towards.length().max(place.radius);
        let angle = length / distance * self.eye_scale(towards.normalize_or(DVec3::NEG_Z));
        Ppd(1.0 / Radians(angle).to_degrees())
    }

    /// Highest frequency that the display shows towards a place, at the eye.
    #[must_use]
    pub fn display_limit(&self, place: &Sphere) -> Cpd {
        let Some(view) = &self.glance.view else {
            return Cpd(f64::INFINITY);
        };
        let towards = (place.centre - self.eye).normalize_or(DVec3::NEG_Z);
        let seen = view.seen_direction(towards).unwrap_or(towards);
        Cpd(view.as_seen().ppd_towards(seen).0 / 2.0)
    }

    /// The direction within `radius` of another that is nearest to the gaze.
    fn nearest(&self, direction: DVec3, radius: Radians) -> DVec3 {
        let gaze = self.glance.gaze.gaze_in_content;
        let apart = angle_between(gaze, direction).0;
        if apart <= radius.0 {
            return gaze;
        }
        let across = gaze - direction * gaze.dot(direction);
        let length = across.length();
        if length < 1e-12 {
            return direction;
        }
        let (sin, cos) = libm::sincos(radius.0);
        direction * cos + across * (sin / length)
    }

    /// Angle at the eye that an angle of the content fills in a direction.
    fn eye_scale(&self, direction: DVec3) -> f64 {
        let view = self.glance.view.as_ref();
        let Some(view) = view.filter(|_| self.glance.is_magnified()) else {
            return 1.0;
        };
        let Some(seen) = view.seen_direction(direction) else {
            return 1.0;
        };
        view.ppd_towards(direction).0 / view.as_seen().ppd_towards(seen).0
    }
}

/// Pixels of a view in a length of one at unit distance ahead, along its finer axis.
fn pixels_at_unit_distance(view: &EyeView) -> f64 {
    let field = view.field;
    let across = f64::from(view.size[0]) / (field.left + field.right);
    across.max(f64::from(view.size[1]) / (field.up + field.down))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::sample::GazeSample;
    use crate::perception::parameters::EyeState;
    use crate::units::Seconds;
    use crate::view::axes::Axes;
    use crate::view::eye_view::Field;
    use crate::view::random::Random;

    fn sight(gaze: DVec3) -> ViewOfScene {
        let view = EyeView {
            position: DVec3::new(0.3, -0.2, 1.0),
            axes: Axes::FRONT,
            field: Field::symmetric([1.0, 0.6]),
            size: [1000, 600],
            eye: Default::default(),
        };
        let glance = Glance {
            gaze: GazeSample {
                gaze_in_content: gaze.normalize(),
                ..GazeSample::at(Seconds(0.0), Default::default(), Default::default())
            },
            view: Some(view),
            state: EyeState::Steady,
        };
        ViewOfScene::new(&glance, Radians(0.1))
    }

    #[test]
    fn a_sphere_round_another_is_seen_with_no_smaller_error_and_no_farther_from_the_gaze() {
        let mut random = Random::new(9);
        for _ in 0..8000 {
            let mut any = || random.unit() * 2.0 - 1.0;
            let ahead = DVec3::new(any() * 4.0, any() * 3.0, -2.0 - 3.0 * any().abs());
            let sight = sight(DVec3::new(any() * 0.6, any() * 0.4, -1.0));
            let inner = Sphere {
                centre: ahead,
                radius: any().abs() * 0.5,
            };
            let shift = DVec3::new(any(), any(), any()) * 0.2;
            let outer = Sphere {
                centre: ahead + shift,
                radius: inner.radius + shift.length() + 1e-9,
            };
            let Some(seen) = sight.seen(&inner, 0.01) else {
                continue;
            };
            let round = sight
                .seen(&outer, 0.01)
                .expect("what is round it is in view");
            assert!(round.error_pixels >= seen.error_pixels * (1.0 - 1e-9));
            assert!(round.eccentricity.0 <= seen.eccentricity.0 + 1e-9);
        }
    }

    #[test]
    fn an_error_is_as_many_pixels_as_its_projection_ahead() {
        let sight = sight(DVec3::NEG_Z);
        let sphere = Sphere {
            centre: DVec3::new(0.3, -0.2, -4.0),
            radius: 1.0,
        };
        let seen = sight.seen(&sphere, 0.008).expect("it is ahead");
        // 500 pixels at unit distance, four metres to the nearest point.
        assert!((seen.error_pixels - 1.0).abs() < 1e-12);
        let behind = Sphere {
            centre: DVec3::new(0.3, -0.2, 6.0),
            ..sphere
        };
        assert_eq!(sight.seen(&behind, 0.008), None);
    }
}
