//! Is a place in view, or nearly?

use crate::units::Radians;
use crate::view::axes::Axes;
use crate::view::eye_view::EyeView;
use glam::DVec3;

/// A view and what lies beside it up to a margin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    axes: Axes,
    /// Angles from ahead to the left, right, upper and lower border, in radians.
    reach: [f64; 4],
}

impl Sight {
    pub(super) fn new(view: &EyeView, margin: Radians) -> Self {
        let field = view.field;
        let borders = [field.left, field.right, field.up, field.down];
        Self {
            axes: view.axes,
            reach: borders.map(|tangent| libm::atan(tangent) + margin.0),
        }
    }

    pub(super) fn reaches(&self, direction: DVec3) -> bool {
        let depth = direction.dot(self.axes.forward);
        let across = libm::atan2(direction.dot(self.axes.right), depth);
        let down = libm::atan2(direction.dot(self.axes.down), depth);
        let [left, right, up, low] = self.reach;
        (-left..=right).contains(&across) && (-up..=low).contains(&down)
    }
}
