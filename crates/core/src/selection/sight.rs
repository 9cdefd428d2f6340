//! Is a place in view, or nearly?

use crate::units::Radians;
use crate::view::axes::Axes;
use crate::view::eye_view::EyeView;
use glam::DVec3;

/// Sines of what is called missed are this far beyond the border.
const ROUNDING: f64 = 1e-9;

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

    /// Whether nothing within `radius` of a direction is reached; false where that is not sure.
    pub(super) fn is_missed_by(&self, centre: DVec3, radius: Radians) -> bool {
        let within = -libm::sin(radius.0.min(core::f64::consts::FRAC_PI_2)) - ROUNDING;
        let missed = |aside: DVec3, [before, after]: [f64; 2]| {
            // Borders less than half a turn apart are planes, and what is reached is above both.
            let mut borders = [(-aside, before), (aside, after)].into_iter();
            before + after < core::f64::consts::PI
                && borders.any(|(outward, reach)| {
                    let (sin, cos) = libm::sincos(reach);
                    (self.axes.forward * sin - outward * cos).dot(centre) < within
                })
        };
        let [left, right, up, low] = self.reach;
        missed(self.axes.right, [left, right]) || missed(self.axes.down, [up, low])
    }

    pub(super) fn reaches(&self, direction: DVec3) -> bool {
        let depth = direction.dot(self.axes.forward);
        let across = libm::atan2(direction.dot(self.axes.right), depth);
        let down = libm::atan2(direction.dot(self.axes.down), depth);
        let [left, right, up, low] = self.reach;
        (-left..=right).contains(&across) && (-up..=low).contains(&down)
    }
}
