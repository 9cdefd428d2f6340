//! Which way do right, down and forward point?
//!
//! The world is right-handed: +x right, +y up, -z the content's forward. Everything that has an
//! orientation (a cube face, an eye, a head) is three unit vectors with `right x down = forward`,
//! the order of image columns, rows and depth.

use crate::units::Radians;
use glam::DVec3;

/// An orthonormal orientation in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Where it looks.
    pub forward: DVec3,
    /// Direction of growing columns.
    pub right: DVec3,
    /// Direction of growing rows.
    pub down: DVec3,
}

impl Axes {
    /// Whether they are unit vectors at right angles, up to a millionth.
    #[must_use]
    pub fn are_square(&self) -> bool {
        const ROUNDING: f64 = 1e-6;
        let axes = [self.right, self.down, self.forward];
        let is_unit = |axis: &DVec3| (axis.length() - 1.0).abs() < ROUNDING;
        let is_square = |(a, b): (usize, usize)| axes[a].dot(axes[b]).abs() < ROUNDING;
        axes.iter().all(is_unit) && [(0, 1), (1, 2), (2, 0)].into_iter().all(is_square)
    }

    /// Looking at the content's forward, upright.
    pub const FRONT: Self = Self {
        forward: DVec3::NEG_Z,
        right: DVec3::X,
        down: DVec3::NEG_Y,
    };

    /// An eye or head turned by `yaw` to the right, then by `pitch` up, then by `roll` clockwise.
    #[must_use]
    pub fn from_yaw_pitch_roll(yaw: Radians, pitch: Radians, roll: Radians) -> Self {
        let forward = direction_from_yaw_pitch(yaw, pitch);
        let level_right = DVec3::new(libm::cos(yaw.0), 0.0, libm::sin(yaw.0));
        let level_down = forward.cross(level_right);
        let (sin, cos) = (libm::sin(roll.0), libm::cos(roll.0));
        Self {
            forward,
            right: level_right * cos + level_down * sin,
            down: level_down * cos - level_right * sin,
        }
    }

    /// The angles that [`from_yaw_pitch_roll`](Self::from_yaw_pitch_roll) makes these axes from.
    #[must_use]
    pub fn yaw_pitch_roll(&self) -> [Radians; 3] {
        let (yaw, pitch) = yaw_pitch_from_direction(self.forward);
        let upright = Self::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
        let across = self.right.dot(upright.right);
        let roll = libm::atan2(self.right.dot(upright.down), across);
        [yaw, pitch, Radians(roll)]
    }

    /// The vector `forward + right * a + down * b` at unit distance, not normalised.
    #[must_use]
    pub fn at(&self, [a, b]: [f64; 2]) -> DVec3 {
        self.forward + self.right * a + self.down * b
    }
}

/// Unit direction of `yaw` (right positive) and `pitch` (up positive) of the content's forward.
#[must_use]
pub fn direction_from_yaw_pitch(yaw: Radians, pitch: Radians) -> DVec3 {
    let level = libm::cos(pitch.0);
    DVec3::new(
        libm::sin(yaw.0) * level,
        libm::sin(pitch.0),
        -libm::cos(yaw.0) * level,
    )
}

/// Yaw in (-pi, pi] and pitch in [-pi/2, pi/2] of a direction; the inverse of
/// [`direction_from_yaw_pitch`].
#[must_use]
pub fn yaw_pitch_from_direction(direction: DVec3) -> (Radians, Radians) {
    let level = (direction.x * direction.x + direction.z * direction.z).sqrt();
    (
        Radians(libm::atan2(direction.x, -direction.z)),
        Radians(libm::atan2(direction.y, level)),
    )
}

/// Angle between two unit directions: eccentricity when one of them is the gaze.
///
/// Exact near 0 and near pi, where the arc cosine of a dot product is not.
#[must_use]
pub fn angle_between(a: DVec3, b: DVec3) -> Radians {
    Radians(libm::atan2(a.cross(b).length(), a.dot(b)))
}

/// The direction that lies `angle` from `from` along the great circle that leaves it at `bearing`
/// (0 is up, growing clockwise as the viewer sees it).
#[must_use]
pub fn direction_at(from: DVec3, bearing: Radians, angle: Radians) -> DVec3 {
    let (yaw, pitch) = yaw_pitch_from_direction(from);
    let axes = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
    let across = axes.right * libm::sin(bearing.0) - axes.down * libm::cos(bearing.0);
    (axes.forward * libm::cos(angle.0) + across * libm::sin(angle.0)).normalize()
}

/// The direction `share` (0 to 1) of the way from one unit direction to another along their great
/// circle; `to` where they coincide or are opposite, which leaves the circle open.
#[must_use]
pub fn direction_between(from: DVec3, to: DVec3, share: f64) -> DVec3 {
    let angle = angle_between(from, to).0;
    let sin = libm::sin(angle);
    if sin < 1e-9 {
        return to;
    }
    let near = libm::sin((1.0 - share) * angle) / sin;
    let far = libm::sin(share * angle) / sin;
    (from * near + to * far).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_down_and_forward_form_one_handedness() {
        for (yaw, pitch, roll) in [(0.0, 0.0, 0.0), (1.0, -0.5, 0.3), (-2.5, 1.2, -1.0)] {
            let axes = Axes::from_yaw_pitch_roll(Radians(yaw), Radians(pitch), Radians(roll));
            assert!((axes.right.cross(axes.down) - axes.forward).length() < 1e-12);
        }
        let front = Axes::from_yaw_pitch_roll(Radians(0.0), Radians(0.0), Radians(0.0));
        assert_eq!(front, Axes::FRONT);
    }

    #[test]
    fn a_share_of_the_way_is_that_share_of_the_angle() {
        let from = direction_from_yaw_pitch(Radians(0.2), Radians(0.1));
        let to = direction_from_yaw_pitch(Radians(1.4), Radians(-0.6));
        let whole = angle_between(from, to).0;
        for share in [0.0, 0.25, 0.5, 1.0] {
            let between = direction_between(from, to, share);
            assert!((angle_between(from, between).0 - share * whole).abs() < 1e-12);
            assert!((angle_between(between, to).0 - (1.0 - share) * whole).abs() < 1e-12);
        }
        assert_eq!(direction_between(from, from, 0.5), from);
    }

    #[test]
    fn yaw_and_pitch_survive_the_way_to_a_direction_and_back() {
        for yaw in -17..=17 {
            for pitch in -8..=8 {
                let (yaw, pitch) = (f64::from(yaw) * 10.0, f64::from(pitch) * 10.0);
                let direction = direction_from_yaw_pitch(
                    Radians::from_degrees(yaw),
                    Radians::from_degrees(pitch),
                );
                let (back_yaw, back_pitch) = yaw_pitch_from_direction(direction);
                assert!((back_yaw.to_degrees() - yaw).abs() < 1e-9);
                assert!((back_pitch.to_degrees() - pitch).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_step_along_a_great_circle_has_the_length_it_was_given() {
        let from = direction_from_yaw_pitch(Radians(0.7), Radians(-0.3));
        for bearing in 0..12 {
            let to = direction_at(from, Radians(f64::from(bearing) * 0.5), Radians(0.2));
            assert!((angle_between(from, to).0 - 0.2).abs() < 1e-12);
        }
        let up = direction_at(from, Radians(0.0), Radians(0.1));
        assert!(up.y > from.y);
    }
}
