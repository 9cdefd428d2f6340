//! How does flat content stand that is not square before the head?

use crate::view::axes::Axes;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A plane turned from the head, and where on it the content has its middle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slant {
    /// Direction of growing columns in the head's space (x right, y up, -z forward).
    pub right: [f64; 3],
    /// Direction of growing rows.
    pub down: [f64; 3],
    /// Towards the place of the plane that is nearest to the eye.
    pub forward: [f64; 3],
    /// Tangents to the right and down from there to the middle of the content.
    pub middle: [f64; 2],
}

impl Slant {
    /// A plane that looks along axes, the content's middle at these tangents.
    #[must_use]
    pub fn new(axes: Axes, middle: [f64; 2]) -> Self {
        Self {
            right: axes.right.to_array(),
            down: axes.down.to_array(),
            forward: axes.forward.to_array(),
            middle,
        }
    }

    /// How the plane is turned.
    #[must_use]
    pub fn axes(&self) -> Axes {
        Axes {
            forward: DVec3::from_array(self.forward),
            right: DVec3::from_array(self.right),
            down: DVec3::from_array(self.down),
        }
    }

    /// What of it no content could lie on, if anything.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        match () {
            () if !self.axes().are_square() => {
                Some("slant: expected three unit vectors at right angles")
            }
            () if !self.middle.iter().all(|t| t.abs() <= 1e6) => {
                Some("slant, middle: expected tangents of at most 1e6")
            }
            () => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Radians;
    use crate::view::eye_view::{EyeView, Field};
    use crate::view::surface::{Eye, Screen, Surface};

    fn slanted() -> Surface {
        let axes = Axes::from_yaw_pitch_roll(Radians(-0.3), Radians(0.1), Radians(0.2));
        let screen = Screen {
            slant: Some(Slant::new(axes, [0.4, -0.1])),
            ..Screen::default()
        };
        Surface::flat([640, 360], screen)
    }

    #[test]
    fn a_place_of_a_slanted_picture_is_where_its_ray_comes_from() {
        let surface = slanted();
        let view = EyeView {
            position: DVec3::ZERO,
            axes: Axes::from_yaw_pitch_roll(Radians(0.1), Radians(0.0), Radians(0.0)),
            field: Field::of([1.0, 0.5, 0.4, 0.7]),
            size: [320, 200],
            eye: Eye::Left,
        };
        let content_from_pixel = view.content_from_pixel(&surface);
        for place in [[0.5, 0.5], [320.0, 180.0], [639.0, 20.0]] {
            let ray = surface.direction(0, place);
            let (_, back) = surface.locate(ray).unwrap();
            let pixel = view.place(ray).unwrap();
            let seen = content_from_pixel * DVec3::new(pixel[0], pixel[1], 1.0);
            for k in 0..2 {
                assert!((back[k] - place[k]).abs() < 1e-9, "{place:?} {back:?}");
                assert!(
                    (seen[k] / seen.z - place[k]).abs() < 1e-6,
                    "{place:?} {seen}"
                );
            }
            assert!(seen.z > 0.0);
        }
        // The middle is the nearest to its own tangents, not to the head.
        let middle = surface.tangent([320.0, 180.0]);
        assert_eq!(middle, [0.4, -0.1]);
    }

    #[test]
    fn what_looks_away_from_a_plane_sees_nothing_of_it() {
        let surface = slanted();
        let view = EyeView {
            position: DVec3::ZERO,
            axes: Axes::from_yaw_pitch_roll(Radians(2.5), Radians(0.0), Radians(0.0)),
            field: Field::symmetric([0.5, 0.5]),
            size: [64, 64],
            eye: Eye::Left,
        };
        let seen = view.content_from_pixel(&surface) * DVec3::new(32.0, 32.0, 1.0);
        assert!(seen.z < 0.0, "{seen}");
    }

    #[test]
    fn axes_that_are_none_and_a_middle_that_is_nowhere_are_faults() {
        let slant = slanted().slant.unwrap();
        assert_eq!(slant.fault(), None);
        let long = Slant {
            right: [2.0, 0.0, 0.0],
            ..slant
        };
        let nowhere = Slant {
            middle: [f64::NAN, 0.0],
            ..slant
        };
        assert!(long.fault().is_some() && nowhere.fault().is_some());
    }
}
