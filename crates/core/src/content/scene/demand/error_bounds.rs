//! What is sure of how an error is seen before any angle is worked out?
//!
//! Arc functions take most of the time of choosing. Here they are short polynomials with a known
//! error; where the answer lies within it [`ViewOfScene::seen`] is asked, so that nothing is chosen
//! otherwise.

use crate::content::scene::sight::{Sphere, ViewOfScene};
use crate::units::Radians;
use core::f64::consts::{FRAC_PI_2, PI};

/// Eccentricities are off by at most this, in radians: two arc functions' errors, with room.
const OFF: f64 = 2e-4;
/// What rounding may change of a number that is compared, as a share of it, with room.
const ROUNDING: f64 = 1e-9;

/// What is sure of how an error is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ErrorBounds {
    /// It is out of view by more than the margin.
    Missed,
    /// It is seen so.
    Seen(RoughError),
    /// Only working it out decides.
    Unsure,
}

/// How an error is seen, about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RoughError {
    /// The error as an angle at the eye, exactly.
    pub(super) error: Radians,
    /// The least and the largest that its eccentricity may be.
    pub(super) eccentricity: [Radians; 2],
}

impl ViewOfScene {
    /// Whether an error in a sphere is surely no larger than so many pixels of the display.
    #[inline]
    pub(super) fn is_surely_within(&self, sphere: &Sphere, error: f64, pixels: f64) -> bool {
        let reach = sphere.radius + error * (self.pixels / pixels);
        (sphere.centre - self.eye).length_squared() > reach * reach * (1.0 + ROUNDING)
    }

    /// What is sure of an error.
    #[inline]
    pub(super) fn look(&self, sphere: &Sphere, error: f64) -> ErrorBounds {
        let towards = sphere.centre - self.eye;
        let distance = towards.length();
        if distance <= sphere.radius || self.glance.is_magnified() {
            return ErrorBounds::Unsure;
        }
        let (direction, share) = (towards / distance, sphere.radius / distance);
        let frustum = self.frustum.as_ref();
        match frustum.map_or(Some(false), |it| it.is_surely_missed(direction, share)) {
            None => return ErrorBounds::Unsure,
            Some(true) => return ErrorBounds::Missed,
            Some(false) => {}
        }
        let apart = arc_cosine(self.glance.gaze.gaze_in_content.dot(direction));
        let radius = FRAC_PI_2 - arc_cosine(share);
        let nearest = apart - radius;
        let effective = |eccentricity: f64| {
            let of_sphere = Radians(eccentricity.clamp(0.0, PI));
            self.spread.effective(of_sphere)
        };
        ErrorBounds::Seen(RoughError {
            error: Radians(error / (distance - sphere.radius)),
            eccentricity: [effective(nearest - OFF), effective(nearest + OFF)],
        })
    }
}

/// Whether a number that rounding and bounds make `least` to `most` is above 1; `None` where that
/// is not sure.
pub(super) fn is_above_one([least, most]: [f64; 2]) -> Option<bool> {
    match () {
        () if most < 1.0 - ROUNDING => Some(false),
        () if least > 1.0 + ROUNDING => Some(true),
        () => None,
    }
}

/// The arc cosine, off by less than 7e-5. Source: Abramowitz and Stegun 1964, 4.4.45.
fn arc_cosine(cosine: f64) -> f64 {
    let x = cosine.abs().min(1.0);
    let series = 1.570_728_8 + x * (-0.212_114_4 + x * (0.074_261_0 - x * 0.018_729_3));
    let angle = (1.0 - x).sqrt() * series;
    if cosine < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_arc_cosine_is_off_by_less_than_a_third_of_what_is_allowed() {
        for step in -100_000..=100_000 {
            let cosine = f64::from(step) / 1e5;
            let off = arc_cosine(cosine) - libm::acos(cosine);
            assert!(off.abs() < OFF / 2.5, "{cosine}: {off}");
        }
    }
}
