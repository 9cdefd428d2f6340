//! What do both eyes of a headset see together?

use foveal_core::gaze::sample::HeadPose;
use foveal_core::units::Radians;
use foveal_core::view::axes::{Axes, yaw_pitch_from_direction};
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::Eye;
use glam::{DQuat, DVec3};

/// What one eye of a headset asks for, as WebXR tells it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EyeRequest {
    pub(crate) eye: Eye,
    /// Columns and rows.
    pub(crate) size: [u32; 2],
    /// Orientation as x, y, z, w.
    pub(crate) orientation: [f64; 4],
    /// Tangents to the left, right, top and bottom.
    pub(crate) tangents: [f64; 4],
}

impl EyeRequest {
    /// Its view; `None` where the numbers are none of an eye.
    pub(crate) fn view(&self) -> Option<EyeView> {
        let turn = DQuat::from_array(self.orientation);
        let whole = turn.is_finite() && turn.length_squared() > 1e-6;
        let turn = whole.then(|| turn.normalize())?;
        let view = EyeView {
            axes: Axes {
                forward: turn * DVec3::NEG_Z,
                right: turn * DVec3::X,
                down: turn * DVec3::NEG_Y,
            },
            field: Field::of(self.tangents),
            size: self.size.map(|side| side.max(1)),
            eye: self.eye,
        };
        view.field.is_open().then_some(view)
    }
}

/// The view that holds what both eyes see, with pixels as dense as theirs.
pub(crate) fn union(left: &EyeView, right: &EyeView) -> EyeView {
    let [a, b] = [left.field, right.field];
    let field = Field::of([
        a.left.max(b.left),
        a.right.max(b.right),
        a.up.max(b.up),
        a.down.max(b.down),
    ]);
    let grown = |whole: f64, of_eye: f64, pixels: u32| {
        (f64::from(pixels) * whole / of_eye.max(1e-6)).ceil() as u32
    };
    let across = [field.left + field.right, a.left + a.right];
    let high = [field.up + field.down, a.up + a.down];
    EyeView {
        field,
        size: [
            grown(across[0], across[1], left.size[0]),
            grown(high[0], high[1], left.size[1]),
        ],
        ..*left
    }
}

/// The pose of a head with these axes.
pub(crate) fn head_of(axes: &Axes) -> HeadPose {
    let (yaw, pitch) = yaw_pitch_from_direction(axes.forward);
    let level = Axes::from_yaw_pitch_roll(yaw, pitch, Radians(0.0));
    let roll = axes
        .right
        .dot(level.down)
        .atan2(axes.right.dot(level.right));
    HeadPose {
        yaw,
        pitch,
        roll: Radians(roll),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(orientation: [f64; 4], tangents: [f64; 4]) -> EyeRequest {
        EyeRequest {
            eye: Eye::Left,
            size: [1000, 800],
            orientation,
            tangents,
        }
    }

    #[test]
    fn an_unturned_eye_looks_forward_and_a_turned_head_is_told_as_its_angles() {
        let tangents = [1.0, 0.8, 0.9, 0.9];
        let view = request([0.0, 0.0, 0.0, 1.0], tangents).view().unwrap();
        assert!((view.axes.forward - Axes::FRONT.forward).length() < 1e-12);
        let axes = Axes::from_yaw_pitch_roll(Radians(0.3), Radians(-0.2), Radians(0.1));
        let head = head_of(&axes);
        assert!((head.yaw.0 - 0.3).abs() < 1e-9 && (head.pitch.0 + 0.2).abs() < 1e-9);
        assert!((head.roll.0 - 0.1).abs() < 1e-9);
        assert_eq!(request([0.0; 4], tangents).view(), None);
        assert_eq!(request([0.0, 0.0, 0.0, 1.0], [f64::NAN; 4]).view(), None);
    }

    #[test]
    fn the_union_holds_both_fields_at_their_density() {
        let [left, right] = [[1.0, 0.8, 0.9, 0.9], [0.8, 1.0, 0.9, 0.9]]
            .map(|tangents| request([0.0, 0.0, 0.0, 1.0], tangents).view().unwrap());
        let both = union(&left, &right);
        assert_eq!([both.field.left, both.field.right], [1.0, 1.0]);
        assert_eq!(both.size, [1112, 800]);
    }
}
