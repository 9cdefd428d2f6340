//! Which way do the eyes look, seen from the head?

use crate::units::Radians;
use crate::view::axes::angle_between;
use glam::DVec3;

/// Farthest that eyes are said to turn from the head's forward along one axis, in degrees: a little
/// less than their mechanical limit of about 55 (Guitton and Volle 1987).
const FARTHEST_DEG: f64 = 50.0;

/// Gaze relative to the head, as angles on the tangent screen before it: the direction is
/// (tan yaw, tan pitch, 1) to the right, up and forward.
///
/// This is the form of eye-head models (Hu et al. 2019); it is not yaw followed by pitch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GazeInHead {
    /// To the right, in degrees.
    pub yaw_deg: f64,
    /// Up, in degrees.
    pub pitch_deg: f64,
}

impl GazeInHead {
    /// Straight ahead: the centre of the view.
    pub const CENTRE: Self = Self {
        yaw_deg: 0.0,
        pitch_deg: 0.0,
    };

    /// The gaze at these angles, held within what eyes can reach.
    #[must_use]
    pub fn within_reach([yaw_deg, pitch_deg]: [f64; 2]) -> Self {
        Self {
            yaw_deg: yaw_deg.clamp(-FARTHEST_DEG, FARTHEST_DEG),
            pitch_deg: pitch_deg.clamp(-FARTHEST_DEG, FARTHEST_DEG),
        }
    }

    /// The angles, yaw first, in degrees.
    #[must_use]
    pub fn degrees(self) -> [f64; 2] {
        [self.yaw_deg, self.pitch_deg]
    }

    /// Unit direction in the head's own axes (+x right, +y up, -z forward).
    #[must_use]
    pub fn direction_in_head(self) -> DVec3 {
        let [x, y] = self
            .degrees()
            .map(|degrees| libm::tan(Radians::from_degrees(degrees).0));
        DVec3::new(x, y, -1.0).normalize()
    }

    /// The angles of a direction in the head's own axes; `None` unless it points forward.
    #[must_use]
    pub fn from_direction_in_head(direction: DVec3) -> Option<Self> {
        (direction.z < 0.0).then(|| {
            let degrees = |tangent: f64| Radians(libm::atan(tangent)).to_degrees();
            Self {
                yaw_deg: degrees(direction.x / -direction.z),
                pitch_deg: degrees(direction.y / -direction.z),
            }
        })
    }

    /// Angle between the two directions.
    #[must_use]
    pub fn angle_to(self, other: Self) -> Radians {
        angle_between(self.direction_in_head(), other.direction_in_head())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_survive_the_way_to_a_direction_and_back() {
        for [yaw, pitch] in [[0.0, 0.0], [12.0, -3.0], [-45.0, 30.0]] {
            let gaze = GazeInHead::within_reach([yaw, pitch]);
            let back = GazeInHead::from_direction_in_head(gaze.direction_in_head()).unwrap();
            assert!(gaze.angle_to(back).to_degrees() < 1e-9, "{back:?}");
        }
        assert_eq!(GazeInHead::from_direction_in_head(DVec3::Z), None);
    }

    #[test]
    fn along_one_axis_the_angle_between_gazes_is_their_difference() {
        let [a, b] = [[20.0, 0.0], [-13.0, 0.0]].map(GazeInHead::within_reach);
        assert!((a.angle_to(b).to_degrees() - 33.0).abs() < 1e-9);
    }

    #[test]
    fn no_prediction_leaves_what_eyes_can_reach() {
        let far = GazeInHead::within_reach([900.0, -90.0]);
        assert_eq!(far.degrees(), [50.0, -50.0]);
    }
}
