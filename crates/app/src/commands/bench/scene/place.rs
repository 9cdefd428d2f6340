//! Where does the eye stand that scenes are measured for?

use super::subject::Subject;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::perception::moment::Moment;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::axes::Axes;
use foveal_core::view::eye_view::{EyeView, Field};
use glam::DVec3;

/// Pixels of what is looked through.
pub(super) const SIZE: [u32; 2] = [1920, 1080];

/// The box that a scene fills.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    low: DVec3,
    high: DVec3,
}

impl Extent {
    /// Of everything that stands in a scene.
    pub(super) fn of(subject: &Subject) -> Self {
        let objects = &subject.file.pack().description().objects;
        let mut extent = Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
        };
        for (object, mesh) in objects.iter().zip(&subject.finest) {
            for world_from_object in object.placements() {
                for vertex in &mesh.vertices {
                    let place = world_from_object.transform_point3(object.grid.at(vertex.place));
                    extent.low = extent.low.min(place);
                    extent.high = extent.high.max(place);
                }
            }
        }
        extent
    }

    /// From side to side.
    pub(super) fn width(&self) -> f64 {
        self.high.x - self.low.x
    }

    /// An eye before the middle of its front, half its width from it, that looks straight ahead.
    pub(super) fn view(&self, across_deg: f64) -> EyeView {
        let middle = (self.low + self.high) / 2.0;
        EyeView {
            position: middle.with_z(self.high.z + self.width() / 2.0),
            axes: Axes::FRONT,
            field: Field::across(Radians::from_degrees(across_deg), SIZE),
            size: SIZE,
            eye: Default::default(),
        }
    }
}

/// A sure gaze through a view, so far to the right and up of straight ahead.
pub(super) fn looking(view: EyeView, [yaw_deg, pitch_deg]: [f64; 2]) -> Moment {
    let [yaw, pitch] = [yaw_deg, pitch_deg].map(Radians::from_degrees);
    Moment::new(GazeSample::at(Seconds(0.0), yaw, pitch), vec![view])
}
