//! How far does an eye with astigmatism spread a point?
//!
//! By rays: Thibos and Thibos 2011, *Geometrical optical analysis of defocused retinal images to
//! compute the size of retinal blur circles relative to object size*. Source: docs/papers.md, row
//! "eye that blurs".

use crate::units::Radians;

/// Default diameter of a pupil, in millimetres: Le Grand 1957,
/// `5 - 3 tanh(0.4 lg L)`, at 24 cd/m², a middling picture on a display of 100.
pub const PUPIL_MM: f64 = 3.5;

/// An eye that is in focus along one meridian only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeBlur {
    /// Dioptres by which it is out of focus across the axis.
    cylinder: f64,
    /// From the horizontal, counter-clockwise as an observer facing the eye sees it.
    axis: Radians,
    /// Metres.
    pupil: f64,
}

impl EyeBlur {
    /// The eye that a cylinder of so many dioptres corrects, its axis in degrees counter-clockwise
    /// as an observer facing the eye sees it, and its pupil in millimetres. Nothing
    /// accommodates, so the sign of the cylinder does not count; axes are the same after 180.
    ///
    /// ```
    /// use foveal_core::view::panel::eye_blur::EyeBlur;
    ///
    /// // With the rule: what is upright stays sharp, and a point becomes an upright line.
    /// let eye = EyeBlur::new(-1.0, 180.0, 4.0);
    /// assert_eq!(eye.spread(), [0.0, 0.001]);
    /// ```
    #[must_use]
    pub fn new(cylinder: f64, axis_deg: f64, pupil_mm: f64) -> Self {
        Self {
            cylinder: cylinder.abs(),
            axis: Radians::from_degrees(axis_deg.rem_euclid(180.0)),
            pupil: pupil_mm / 1000.0,
        }
    }

    /// Visual angle, to the right and down as the eye sees it, of one standard deviation of what a
    /// point straight ahead becomes: a line across the axis.
    ///
    /// The rays of a pupil of diameter p meet the retina in a disc of the visual angle p C where C
    /// dioptres miss the focus. Along the axis nothing misses, so the disc is pressed to a line,
    /// whose variance is (p C)² / 16.
    #[must_use]
    pub fn spread(&self) -> [f64; 2] {
        let deviation = self.pupil * self.cylinder / 4.0;
        // Who faces the eye sees right and left change places: counter-clockwise to them, so
        // clockwise to the eye, in the sense of columns and rows.
        let (sin, cos) = (libm::sin(self.axis.0), libm::cos(self.axis.0));
        [-sin * deviation + 0.0, cos * deviation]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_half_a_turn_further_and_the_other_sign_are_the_same_eye() {
        for axis in [0.0, 30.0, 45.0, 90.0, 179.5] {
            let eye = EyeBlur::new(-2.0, axis, PUPIL_MM);
            assert_eq!(eye, EyeBlur::new(2.0, axis, PUPIL_MM));
            assert_eq!(eye, EyeBlur::new(-2.0, axis + 180.0, PUPIL_MM));
            assert_eq!(eye, EyeBlur::new(-2.0, axis - 180.0, PUPIL_MM));
        }
        assert_eq!(EyeBlur::new(0.0, 30.0, PUPIL_MM).spread(), [0.0; 2]);
    }

    #[test]
    fn what_faces_the_observer_at_45_degrees_goes_up_to_the_left_of_the_eye() {
        // So the line across it goes up to the right: left and down, or right and up.
        let [right, down] = EyeBlur::new(1.0, 45.0, 4.0).spread();
        assert!((right + down).abs() < 1e-18 && right < 0.0);
        assert!(((right * right + down * down).sqrt() - 0.001).abs() < 1e-15);
    }
}
