//! What does one eye of a headset see?

use foveal_core::gaze::sample::HeadPose;
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use foveal_core::view::surface::Eye;
use glam::{DQuat, DVec3};

/// What one eye of a headset asks for, as WebXR gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EyeRequest {
    pub(crate) eye: Eye,
    /// Columns and rows.
    pub(crate) size: [u32; 2],
    /// Where it is, from where the head began, in metres.
    pub(crate) position: [f64; 3],
    /// Orientation as x, y, z, w.
    pub(crate) orientation: [f64; 4],
    /// Tangents to the left, right, top and bottom.
    pub(crate) tangents: [f64; 4],
}

impl EyeRequest {
    /// Its view; `None` where the numbers do not describe an eye. Through a scene the head moves
    /// from `start` on; pictures around it, which have none, move along with it.
    pub(crate) fn view(&self, start: Option<DVec3>) -> Option<EyeView> {
        let moved = DVec3::from_array(self.position);
        let position = start.map_or(DVec3::ZERO, |start| start + moved);
        if !position.is_finite() {
            return None;
        }
        let turn = DQuat::from_array(self.orientation);
        let whole = turn.is_finite() && turn.length_squared() > 1e-6;
        let turn = whole.then(|| turn.normalize())?;
        let axes = Axes {
            forward: turn * DVec3::NEG_Z,
            right: turn * DVec3::X,
            down: turn * DVec3::NEG_Y,
        };
        let view = EyeView {
            position,
            // As its angles give it, which is what a log keeps.
            axes: HeadPose::of(&axes).axes(),
            field: Field::of(self.tangents),
            size: self.size.map(|side| side.max(1)),
            eye: self.eye,
        };
        view.field.is_open().then_some(view)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(orientation: [f64; 4], tangents: [f64; 4]) -> EyeRequest {
        EyeRequest {
            eye: Eye::Left,
            size: [1000, 800],
            position: [0.0, 0.5, 0.0],
            orientation,
            tangents,
        }
    }

    #[test]
    fn an_unturned_eye_looks_forward_and_numbers_of_no_eye_are_refused() {
        let tangents = [1.0, 0.8, 0.9, 0.9];
        let view = request([0.0, 0.0, 0.0, 1.0], tangents).view(None).unwrap();
        assert!((view.axes.forward - Axes::FRONT.forward).length() < 1e-12);
        assert_eq!(request([0.0; 4], tangents).view(None), None);
        let nowhere = request([0.0, 0.0, 0.0, 1.0], [f64::NAN; 4]);
        assert_eq!(nowhere.view(None), None);
    }

    #[test]
    fn a_head_moves_through_a_scene_and_not_through_video() {
        let request = request([0.0, 0.0, 0.0, 1.0], [1.0; 4]);
        let place = |start| request.view(start).unwrap().position;
        assert_eq!(place(None), DVec3::ZERO);
        let start = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(place(Some(start)), DVec3::new(1.0, 2.5, 3.0));
    }
}
