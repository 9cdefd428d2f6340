//! What is known of a viewer at one display time, through one view?

use crate::gaze::sample::GazeSample;
use crate::perception::parameters::EyeState;
use crate::units::Radians;
use crate::view::axes::angle_between;
use crate::view::eye_view::EyeView;
use glam::DVec3;

/// A [`Moment`](crate::perception::moment::Moment) through one of its views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glance {
    /// Where the eye looks when the picture is shown.
    pub gaze: GazeSample,
    /// What shows the picture; without it nothing is cut to the display's density.
    pub view: Option<EyeView>,
    /// What the eye does, as far as the worth of a step depends on it.
    pub state: EyeState,
}

impl Glance {
    /// Angle at the eye between the gaze and a direction in the content's space; half a turn for
    /// what a picture that fills other angles at the eye does not show.
    #[must_use]
    pub fn eccentricity(&self, direction: DVec3) -> Radians {
        let seen = self.seen([self.gaze.gaze_in_content, direction]);
        seen.map_or(Radians(core::f64::consts::PI), |[gaze, direction]| {
            angle_between(gaze, direction)
        })
    }

    /// The same for content on a surface around the head, which looks the same from everywhere.
    pub(crate) fn on_surface(&self) -> Self {
        let view = self.view.map(|view| EyeView {
            position: DVec3::ZERO,
            ..view
        });
        Self { view, ..*self }
    }

    /// Directions as they appear to the eye; `None` where one of them is not shown.
    pub(crate) fn seen<const N: usize>(&self, directions: [DVec3; N]) -> Option<[DVec3; N]> {
        let Some(view) = &self.view else {
            return Some(directions);
        };
        let seen = directions.map(|direction| view.seen_direction(direction));
        seen.iter()
            .all(Option::is_some)
            .then(|| seen.map(Option::unwrap_or_default))
    }

    /// Whether the picture fills other angles at the eye than the content does around it.
    pub(crate) fn is_magnified(&self) -> bool {
        self.view.is_some_and(|view| view.field.at_eye.is_some())
    }
}
