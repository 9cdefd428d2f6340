//! Where a viewer looks, and when: the one place in which these tests say so.

use foveal_core::gaze::sample::{GazeSample, HeadPose};
use foveal_core::perception::moment::Moment;
use foveal_core::session::actions::{Now, Pace};
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::eye_view::{EyeView, Field};

/// The moment of a viewer who turns the eye by so many radians to the right and up, before a
/// window of so many pixels on a side.
pub(crate) fn looking(wall: f64, media: f64, pace: Pace, gaze: [f64; 2], side: u32) -> Now {
    let [yaw, pitch] = gaze.map(Radians);
    let size = [side; 2];
    let view = EyeView {
        position: Default::default(),
        axes: HeadPose::default().axes(),
        field: Field::across(Radians::from_degrees(90.0), size),
        size,
        eye: Default::default(),
    };
    let gaze = GazeSample::at(Seconds(wall), yaw, pitch);
    Now {
        wall: Seconds(wall),
        media: Seconds(media),
        pace,
        drawing: Seconds(0.0),
        until: Seconds(wall),
        moment: Moment::new(gaze, vec![view]),
    }
}
