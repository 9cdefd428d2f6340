//! Where before the eye does a pixel lie, and how far from the gaze?
//!
//! Mantiuk et al. 2021, display geometry: eccentricity, and how many more pixels a degree holds
//! away from the middle of a flat panel.

use super::rules::GeometryRule;
use super::viewing::Viewing;

/// Largest angle from the middle of the panel, degrees.
const MOST_ANGLE_DEG: f64 = 89.9;
/// Beyond this tangents are no finite numbers; the direction is that of a right angle long before.
const FARTHEST_PX: f64 = 1e300;

/// The frame before the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Half of the frame's width and height over the panel's distance.
    half: [f64; 2],
    /// Columns and rows of the frame.
    size: [f64; 2],
    /// Half a pixel in the middle of the panel, radians.
    half_pixel: f64,
    rule: GeometryRule,
}

/// A place before the eye: tangents to the right and down from the middle of the panel.
pub type Tangents = [f64; 2];

impl Geometry {
    /// Of the frames of `viewing`.
    #[must_use]
    pub fn new(viewing: &Viewing) -> Self {
        let display = &viewing.display;
        let size = viewing.size.map(f64::from);
        let half = [0, 1].map(|axis| match viewing.rules.geometry {
            GeometryRule::Stretched => display.extent[axis] / 2.0,
            GeometryRule::TrueRays => {
                display.extent[axis] / f64::from(display.size_px[axis]) * size[axis] / 2.0
            }
        });
        Self {
            half,
            size,
            half_pixel: (0.5 / display.ppd()).to_radians(),
            rule: viewing.rules.geometry,
        }
    }

    /// The tangent of column (axis 0) or row (axis 1) `index` of a level that has `length` of them.
    #[must_use]
    pub fn tangent(&self, axis: usize, index: usize, length: usize) -> f64 {
        let share = (index as f64 + 0.5) / length as f64;
        (share * 2.0 - 1.0) * self.half[axis]
    }

    /// Where a gaze is, given in pixels of the frame: 0 is the middle of the first column or row.
    /// It may lie outside of the frame, as far as finite numbers go.
    #[must_use]
    pub fn gaze(&self, gaze_px: [f64; 2]) -> Tangents {
        let place = gaze_px.map(|place| place.clamp(-FARTHEST_PX, FARTHEST_PX));
        let gaze = [0, 1]
            .map(|axis| ((place[axis] + 0.5) / self.size[axis] * 2.0 - 1.0) * self.half[axis]);
        match self.rule {
            GeometryRule::Stretched => gaze,
            // Products of tangents near a right angle leave single precision.
            GeometryRule::TrueRays => {
                let most = MOST_ANGLE_DEG.to_radians().tan();
                let nearer = (most / gaze[0].hypot(gaze[1])).min(1.0);
                gaze.map(|tangent| tangent * nearer)
            }
        }
    }

    /// Degrees between a place and the gaze.
    #[must_use]
    pub fn eccentricity_deg(&self, place: Tangents, gaze: Tangents) -> f64 {
        let [dx, dy] = match self.rule {
            GeometryRule::Stretched => [0, 1].map(|k| place[k].atan() - gaze[k].atan()),
            GeometryRule::TrueRays => {
                let apart = [0, 1].map(|k| place[k] - gaze[k]);
                let turned = apart[0] * gaze[1] - apart[1] * gaze[0];
                let cross = apart[0].hypot(apart[1]).hypot(turned);
                let dot = 1.0 + place[0] * gaze[0] + place[1] * gaze[1];
                return cross.atan2(dot).to_degrees();
            }
        };
        dx.hypot(dy).to_degrees()
    }

    /// Pixels per degree at a place over those in the middle of the panel:
    /// `[tan(a + d) - tan a] / tan d` at the angle `a` from there, `d` being half a pixel.
    #[must_use]
    pub fn magnification(&self, place: Tangents) -> f64 {
        let angle = match self.rule {
            GeometryRule::Stretched => place[0].atan().hypot(place[1].atan()),
            GeometryRule::TrueRays => place[0].hypot(place[1]).atan(),
        };
        let angle = angle.min(MOST_ANGLE_DEG.to_radians() - self.half_pixel);
        ((angle + self.half_pixel).tan() - angle.tan()) / self.half_pixel.tan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::{Display, Mode};

    fn geometry(size: [u32; 2], mode: Mode) -> Geometry {
        let display = Display::named("standard_hmd").unwrap();
        Geometry::new(&Viewing::new(display, size, None, true, mode).unwrap())
    }

    #[test]
    fn density_off_the_axis_has_its_golden_values() {
        let geometry = geometry([1440, 1600], Mode::Compat);
        for (degrees, wanted) in [(0.0, 1.0), (20.0, 1.1327), (40.0, 1.7050), (50.0, 2.4222)] {
            let place = [f64::to_radians(degrees).tan(), 0.0];
            let found = geometry.magnification(place);
            assert!((found - wanted).abs() < 2e-4, "{degrees}: {found}");
        }
    }

    #[test]
    fn both_rules_agree_along_an_axis_through_the_middle_of_a_whole_panel() {
        let [compat, strict] =
            [Mode::Compat, Mode::Strict].map(|mode| geometry([1440, 1600], mode));
        for column in (0..1440).step_by(71) {
            let place = [compat.tangent(0, column, 1440), 0.0];
            assert!((place[0] - strict.tangent(0, column, 1440)).abs() < 1e-12);
            let [a, b] = [compat, strict].map(|g| g.eccentricity_deg(place, [0.2, 0.0]));
            assert!((a - b).abs() < 1e-9, "{column}: {a} {b}");
        }
    }

    #[test]
    fn a_small_frame_fills_the_panel_or_its_own_size() {
        let [compat, strict] = [Mode::Compat, Mode::Strict].map(|mode| geometry([144, 160], mode));
        let [wide, own] = [compat, strict].map(|g| g.tangent(0, 143, 144));
        assert!((wide / own - 10.0).abs() < 1e-9);
    }

    #[test]
    fn the_gaze_is_where_its_pixel_is() {
        for mode in [Mode::Compat, Mode::Strict] {
            let geometry = geometry([321, 243], mode);
            let place = [geometry.tangent(0, 17, 321), geometry.tangent(1, 200, 243)];
            let gaze = geometry.gaze([17.0, 200.0]);
            assert!(geometry.eccentricity_deg(place, gaze) < 1e-9);
            let near = geometry.eccentricity_deg([0.3, 0.1], gaze);
            assert!(geometry.eccentricity_deg([0.6, 0.1], gaze) > near);
        }
    }

    #[test]
    fn a_gaze_outside_is_as_far_as_its_direction_and_never_further_than_it_can_be() {
        for mode in [Mode::Compat, Mode::Strict] {
            let geometry = geometry([1440, 1600], mode);
            let middle = geometry.gaze([719.5, 799.5]);
            // Pixels are square: as far again to the right as the edge is from the middle.
            let beyond = geometry.gaze([719.5 + 1440.0, 799.5]);
            let edge = geometry.gaze([719.5 + 720.0, 799.5])[0];
            let found = geometry.eccentricity_deg(middle, beyond);
            assert!((found - (2.0 * edge).atan().to_degrees()).abs() < 1e-9);
            let mut before = found;
            for place in [1e4, 1e6, 1e12, 1e30, 1e200, f64::MAX] {
                let far = geometry.eccentricity_deg(middle, geometry.gaze([place, 799.5]));
                assert!(
                    far >= before - 1e-9 && far <= 90.0,
                    "{mode:?} {place}: {far}"
                );
                before = far;
                let corner = geometry.gaze([-place, f64::MAX]);
                let all = [
                    geometry.tangent(0, 1439, 1440),
                    geometry.tangent(1, 0, 1600),
                ];
                let far = geometry.eccentricity_deg(all, corner);
                assert!(far > 90.0 && far < 200.0, "{mode:?} {place}: {far}");
            }
            assert!(before > 89.8, "{mode:?}: {before}");
        }
    }
}
