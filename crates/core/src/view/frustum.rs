//! Is a place in view, or nearly?

use crate::units::Radians;
use crate::view::axes::Axes;
use crate::view::eye_view::EyeView;
use core::f64::consts::{FRAC_PI_2, PI};
use glam::DVec3;

/// Sines of what is called missed are this far beyond the border.
const ROUNDING: f64 = 1e-9;

/// A view and what lies outside it up to a margin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    axes: Axes,
    /// Angles from ahead to the left, right, upper and lower border, in radians.
    borders: [f64; 4],
    /// The normals, outward, of the planes through the eye and these borders.
    planes: [DVec3; 4],
    /// The same of the borders moved outward by the margin.
    moved_planes: [DVec3; 4],
    /// Whether the moved borders to the sides, and those up and down, still bound less than half of
    /// all directions.
    bounds: [bool; 2],
    margin: f64,
    /// Angle from ahead to what is a margin beyond the farthest corner.
    farthest: f64,
}

impl Frustum {
    pub(crate) fn new(view: &EyeView, margin: Radians) -> Self {
        let field = view.field;
        let across = field.left.abs().max(field.right.abs());
        let down = field.up.abs().max(field.down.abs());
        let borders = [field.left, field.right, field.up, field.down].map(libm::atan);
        let moved = borders.map(|border| border + margin.0);
        Self {
            moved_planes: outward(&view.axes, moved),
            bounds: [moved[0] + moved[1] < PI, moved[2] + moved[3] < PI],
            axes: view.axes,
            borders,
            planes: outward(&view.axes, borders),
            margin: margin.0,
            farthest: libm::atan(libm::hypot(across, down)) + margin.0,
        }
    }

    /// Whether nothing within `radius` of a direction is reached; false where that is not sure.
    pub(crate) fn is_missed_by(&self, centre: DVec3, radius: Radians) -> bool {
        if self.is_wide() {
            let away = self.margin + radius.0;
            return away < FRAC_PI_2 && self.beyond_borders(centre) > libm::sin(away) + ROUNDING;
        }
        let within = libm::sin(radius.0.min(FRAC_PI_2)) + ROUNDING;
        // What is reached lies before all planes through borders that are moved by the margin.
        self.beyond_moved(centre) > within
    }

    /// Whether nothing is reached within the angle of this sine from a direction, as
    /// [`Self::is_missed_by`] says it; `None` where deciding that needs the angle.
    pub(crate) fn is_surely_missed(&self, centre: DVec3, sine: f64) -> Option<bool> {
        if self.is_wide() {
            return None;
        }
        let over = self.beyond_moved(centre) - (sine + ROUNDING);
        // Far more than the sine of an arc sine is off.
        (over.abs() > ROUNDING / 2.0).then_some(over > 0.0)
    }

    /// Whether nothing is reached between these directions; false where that is not sure.
    pub(crate) fn is_missed_between<const N: usize>(&self, directions: [DVec3; N]) -> bool {
        let bounds = [
            self.bounds[0],
            self.bounds[0],
            self.bounds[1],
            self.bounds[1],
        ];
        let mut planes = self.moved_planes.iter().zip(bounds);
        !self.is_wide()
            && planes.any(|(plane, bounds)| {
                bounds && directions.iter().all(|it| plane.dot(*it) > ROUNDING)
            })
    }

    /// Sine of the angle by which a direction is beyond the plane of a border moved by the margin.
    fn beyond_moved(&self, centre: DVec3) -> f64 {
        let [left, right, up, low] = self.moved_planes.map(|plane| plane.dot(centre));
        let across = if self.bounds[0] {
            left.max(right)
        } else {
            -1.0
        };
        let down = if self.bounds[1] { up.max(low) } else { -1.0 };
        across.max(down)
    }

    /// Whether a direction is in view or at most a margin outside it.
    ///
    /// The margin counts along the circles round the axes to the right and down. Where the view is
    /// wide, they become small or lie behind the eye: there what is no farther than the margin from
    /// the planes of all borders is reached as well.
    ///
    /// Takes unit vectors.
    pub(crate) fn reaches(&self, direction: DVec3) -> bool {
        let depth = direction.dot(self.axes.forward);
        if !self.is_wide() {
            let beyond = self.beyond_moved(direction);
            // Angles are only needed at the border itself.
            if beyond > ROUNDING || (beyond < -ROUNDING && depth > ROUNDING) {
                return beyond < 0.0;
            }
        }
        let across = libm::atan2(direction.dot(self.axes.right), depth);
        let down = libm::atan2(direction.dot(self.axes.down), depth);
        let [left, right, up, low] = self.borders.map(|border| border + self.margin);
        (-left..=right).contains(&across) && (-up..=low).contains(&down)
            || self.is_wide()
                && depth >= libm::cos(self.farthest.min(PI))
                && self.beyond_borders(direction) <= libm::sin(self.margin.min(FRAC_PI_2))
    }

    /// Whether something at the side of or behind the eye is reached.
    fn is_wide(&self) -> bool {
        self.farthest >= FRAC_PI_2
    }

    /// Sine of the angle by which a direction is beyond the plane of the border that it is most
    /// beyond; negative within all.
    fn beyond_borders(&self, direction: DVec3) -> f64 {
        let beyond = self.planes.map(|plane| plane.dot(direction));
        beyond.into_iter().fold(f64::MIN, f64::max)
    }
}

/// The normals, outward, of planes through the eye at these angles from ahead, to the left, right,
/// up and down.
fn outward(axes: &Axes, angles: [f64; 4]) -> [DVec3; 4] {
    let towards = [-axes.right, axes.right, -axes.down, axes.down];
    core::array::from_fn(|k| {
        let (sin, cos) = libm::sincos(angles[k]);
        towards[k] * cos - axes.forward * sin
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::direction_at;
    use crate::view::eye_view::Field;
    use crate::view::random::Random;
    use crate::view::surface::Eye;

    #[test]
    fn planes_and_angles_agree_on_what_is_reached() {
        let mut random = Random::new(4);
        for (field, margin_deg) in [
            ([1.2, 1.2, 1.2, 1.2], 0.0),
            ([0.3, 0.9, 0.5, 0.2], 12.0),
            ([-0.3, 0.5, -0.1, 0.2], 0.0),
            ([0.1, 0.1, 0.1, 0.1], 70.0),
        ] {
            let view = EyeView {
                position: Default::default(),
                axes: Axes::from_yaw_pitch_roll(Radians(0.3), Radians(0.2), Radians(0.1)),
                field: Field::of(field),
                size: [1000, 800],
                eye: Eye::Left,
            };
            let margin = Radians::from_degrees(margin_deg);
            let sight = Frustum::new(&view, margin);
            assert!(!sight.is_wide());
            for _ in 0..4000 {
                let direction = random.direction();
                let depth = direction.dot(view.axes.forward);
                let across = libm::atan2(direction.dot(view.axes.right), depth);
                let down = libm::atan2(direction.dot(view.axes.down), depth);
                let [left, right, up, low] = field.map(|side| libm::atan(side) + margin.0);
                let inside = (-left..=right).contains(&across) && (-up..=low).contains(&down);
                assert_eq!(sight.reaches(direction), inside, "{field:?} {direction:?}");
            }
        }
    }

    #[test]
    fn a_wide_view_reaches_everything_within_its_margin_and_nothing_far_beyond() {
        let mut random = Random::new(3);
        for (field, margin_deg) in [([7.6, 6.1], 10.0), ([1.2, 6.1], 15.0), ([1.0, 0.6], 43.0)] {
            let view = EyeView {
                position: Default::default(),
                axes: Axes::FRONT,
                field: Field::symmetric(field),
                size: [1000, 800],
                eye: Eye::Left,
            };
            let margin = Radians::from_degrees(margin_deg);
            let sight = Frustum::new(&view, margin);
            assert!(sight.is_wide());
            for _ in 0..4000 {
                let place = view.size.map(|side| random.unit() * f64::from(side));
                let shown = view.ray(place).normalize();
                let bearing = Radians(random.unit() * 2.0 * PI);
                let beside = direction_at(shown, bearing, Radians(random.unit() * margin.0));
                assert!(sight.reaches(beside), "{field:?} {place:?} {beside:?}");
                assert!(!sight.is_missed_by(beside, Radians(0.0)));
            }
            assert!(!sight.reaches(-Axes::FRONT.forward));
        }
    }
}
