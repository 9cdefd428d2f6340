//! Which ray belongs to a pixel of what shows the picture?

use super::axes::Axes;
use super::surface::{Eye, Surface};
use crate::units::{Ppd, Radians};
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// A view: a pose, a field of view and pixels. A window, a headset eye, a panel and a screenshot
/// are all views; the contract between display and content is the ray of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeView {
    /// Where the eye is in world space, in metres. Pictures on a surface around the viewer look the
    /// same from everywhere.
    pub position: DVec3,
    /// Orientation in world space.
    pub axes: Axes,
    /// Field of view as tangents at unit distance.
    pub field: Field,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Whose picture it shows, where each eye has its own.
    pub eye: Eye,
}

/// Tangents of the four half angles of a field of view, each measured outwards from the axis: a
/// side beyond the axis is negative.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// To the left.
    pub left: f64,
    /// To the right.
    pub right: f64,
    /// Up.
    pub up: f64,
    /// Down.
    pub down: f64,
    /// The same four tangents of the angles that the picture fills at the viewer's eye; `None`
    /// where those are the angles of the content. They differ in a window on a desk, which fills
    /// the same part of the eye's field whatever it shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_eye: Option<[f64; 4]>,
}

impl Field {
    /// A field of tangents to the left, right, up and down, as the content fills it at the eye.
    #[must_use]
    pub fn of([left, right, up, down]: [f64; 4]) -> Self {
        Self {
            left,
            right,
            up,
            down,
            at_eye: None,
        }
    }

    /// A symmetric field with the given half tangents.
    #[must_use]
    pub fn symmetric([x, y]: [f64; 2]) -> Self {
        Self::of([x, x, y, y])
    }

    /// Whether a picture can be seen through it: finite tangents, and a width and height of 1e-6 to
    /// 2e6 at unit distance, of the content as at the eye.
    #[must_use]
    pub fn is_open(&self) -> bool {
        let own = [self.left, self.right, self.up, self.down];
        let open = |[left, right, up, down]: [f64; 4]| {
            [left, right, up, down].iter().all(|t| t.abs() <= 1e6)
                && [left + right, up + down].iter().all(|side| *side >= 1e-6)
        };
        open(own) && self.at_eye.is_none_or(open)
    }

    /// A symmetric field `across` wide whose pixels are square in a picture of `size`.
    #[must_use]
    pub fn across(across: Radians, size: [u32; 2]) -> Self {
        let x = libm::tan(across.0 / 2.0);
        Self::symmetric([x, x * f64::from(size[1]) / f64::from(size[0])])
    }

    /// A symmetric field whose pixels are square in a picture of `size`, and whose larger side is
    /// `across` wide: what is held upright shows no more at once than what lies on its side.
    #[must_use]
    pub fn of_larger_side(across: Radians, size: [u32; 2]) -> Self {
        Self::reaching(libm::tan(across.0 / 2.0), size)
    }

    /// The same, by half the tangent of the larger side.
    pub(super) fn reaching(tangent: f64, size: [u32; 2]) -> Self {
        let larger = size[0].max(size[1]);
        Self::symmetric(size.map(|side| match side {
            side if side == larger => tangent,
            side => tangent * f64::from(side) / f64::from(larger),
        }))
    }
}

impl EyeView {
    /// The view that flat content fills exactly, at `size` pixels.
    #[must_use]
    pub fn filling(surface: &Surface, size: [u32; 2]) -> Self {
        Self {
            position: DVec3::ZERO,
            axes: Axes::FRONT,
            field: Field::symmetric(surface.tangents),
            size,
            eye: Eye::Left,
        }
    }

    /// The view of `size` pixels in which flat content is as large as it fits in its own shape, in
    /// the middle; what is about the same shape it fills exactly.
    #[must_use]
    pub fn holding(surface: &Surface, size: [u32; 2]) -> Self {
        let filling = Self::filling(surface, size);
        // Half the tangent of a pixel, along each axis if the content filled it.
        let steps = [0, 1].map(|k| surface.tangents[k] / f64::from(size[k].max(1)));
        let step = steps[0].max(steps[1]);
        // Pixels that would stay empty: less than one is rounding.
        let empty = [0, 1].map(|k| f64::from(size[k]) * (1.0 - steps[k] / step));
        if empty.iter().all(|pixels| *pixels < 1.0) {
            return filling;
        }
        Self {
            field: Field::symmetric(size.map(|side| f64::from(side) * step)),
            ..filling
        }
    }

    /// The view of `size` pixels of flat content from `corner` on, pixel for pixel.
    #[must_use]
    pub fn of_part(surface: &Surface, corner: [u32; 2], size: [u32; 2]) -> Self {
        let tangent = |k: usize, pixel: u32| {
            let share = f64::from(pixel) / f64::from(surface.size[k]);
            (2.0 * share - 1.0) * surface.tangents[k]
        };
        let [left, up] = [0, 1].map(|k| -tangent(k, corner[k]));
        let [right, down] = [0, 1].map(|k| tangent(k, corner[k] + size[k]));
        Self {
            field: Field::of([left, right, up, down]),
            ..Self::filling(surface, size)
        }
    }

    /// World ray of a place in the picture (pixel centres at +0.5), not normalised.
    #[must_use]
    pub fn ray(&self, place: [f64; 2]) -> DVec3 {
        let m = self.ray_from_pixel();
        m * DVec3::new(place[0], place[1], 1.0)
    }

    /// The matrix that turns (column, row, 1) into a world ray.
    #[must_use]
    pub fn ray_from_pixel(&self) -> DMat3 {
        let f = self.field;
        let step_x = self.axes.right * ((f.left + f.right) / f64::from(self.size[0]));
        let step_y = self.axes.down * ((f.up + f.down) / f64::from(self.size[1]));
        DMat3::from_cols(step_x, step_y, self.axes.at([-f.left, -f.up]))
    }

    /// The matrix that turns (column, row, 1) into what the reconstruct passes look up: the world
    /// ray where content lies all around; on flat content the homogeneous place in level-0 pixels,
    /// exactly the identity when the view shows the content pixel for pixel.
    #[must_use]
    pub fn content_from_pixel(&self, surface: &Surface) -> DMat3 {
        let rays = self.ray_from_pixel();
        if surface.projection.surrounds() {
            return rays;
        }
        let face = surface.axes(0);
        let [half_w, half_h] = surface.size.map(|s| f64::from(s) / 2.0);
        let [a, b] = [0, 1].map(|k| 1.0 - surface.middle()[k] / surface.tangents[k]);
        let row_x = face.right * (half_w / surface.tangents[0]) + face.forward * (half_w * a);
        let row_y = face.down * (half_h / surface.tangents[1]) + face.forward * (half_h * b);
        let place_from_ray = DMat3::from_cols(row_x, row_y, face.forward).transpose();
        let m = place_from_ray * rays;
        // Of a pixel that looks away from the content the last stays negative.
        let m = m * (1.0 / m.z_axis.z.abs().max(1e-9));
        DMat3::from_cols_array(&m.to_cols_array().map(snap))
    }

    /// The place in the picture where a world direction appears, when it is in front of the eye.
    #[must_use]
    pub fn place(&self, direction: DVec3) -> Option<[f64; 2]> {
        let depth = direction.dot(self.axes.forward);
        if depth <= 1e-9 {
            return None;
        }
        let f = self.field;
        let a = direction.dot(self.axes.right) / depth;
        let b = direction.dot(self.axes.down) / depth;
        Some([
            (a + f.left) / (f.left + f.right) * f64::from(self.size[0]),
            (b + f.up) / (f.up + f.down) * f64::from(self.size[1]),
        ])
    }

    /// This view as it appears to the eye: the same pixels, in the angles that they fill there.
    #[must_use]
    pub fn as_seen(&self) -> Self {
        Self {
            field: self.field.at_eye.map_or(self.field, Field::of),
            ..*self
        }
    }

    /// The direction in which a world direction appears to the eye: itself, unless the picture
    /// fills other angles there than those of the content. `None` behind such a picture.
    #[must_use]
    pub fn seen_direction(&self, direction: DVec3) -> Option<DVec3> {
        if self.field.at_eye.is_none() {
            return Some(direction);
        }
        let place = self.place(direction)?;
        Some(self.as_seen().ray(place).normalize())
    }

    /// What content of `ppd` pixels per degree has at the eye, in a world direction.
    #[must_use]
    pub fn seen_ppd(&self, ppd: Ppd, direction: DVec3) -> Ppd {
        if self.field.at_eye.is_none() {
            return ppd;
        }
        let Some(seen) = self.seen_direction(direction) else {
            return ppd;
        };
        Ppd(ppd.0 * self.as_seen().ppd_towards(seen).0 / self.ppd_towards(direction).0)
    }

    /// Pixels per degree in a world direction, across the radius; outside the field that of its
    /// farthest corner.
    #[must_use]
    pub fn ppd_towards(&self, direction: DVec3) -> Ppd {
        let corner = self.farthest_corner();
        let depth = direction.dot(self.axes.forward);
        let inside = |across: f64, most: f64| {
            if depth <= 1e-9 {
                most
            } else {
                (across / depth).abs().min(most)
            }
        };
        let a = inside(direction.dot(self.axes.right), corner[0]);
        let b = inside(direction.dot(self.axes.down), corner[1]);
        self.ppd_at([a, b])
    }

    /// Level-0 pixels on a side that one pixel of the display covers where content of `ppd` pixels
    /// per degree lies in a world direction.
    #[must_use]
    pub fn footprint(&self, ppd: Ppd, direction: DVec3) -> f64 {
        ppd.0 / self.ppd_towards(direction).0
    }

    /// Pixels per degree in the farthest corner, where they are densest: however the head turns, no
    /// direction is shown with more.
    #[must_use]
    pub fn most_ppd(&self) -> Ppd {
        self.ppd_at(self.farthest_corner())
    }

    /// Pixels per degree straight ahead, where they are fewest.
    #[must_use]
    pub fn least_ppd(&self) -> Ppd {
        self.ppd_at([0.0; 2])
    }

    fn farthest_corner(&self) -> [f64; 2] {
        let f = self.field;
        [f.left.max(f.right), f.up.max(f.down)]
    }

    /// Pixels per degree where the tangents to the right and down are these.
    fn ppd_at(&self, [a, b]: [f64; 2]) -> Ppd {
        let f = self.field;
        let pitch_x = (f.left + f.right) / f64::from(self.size[0]);
        let pitch_y = (f.up + f.down) / f64::from(self.size[1]);
        let spacing = Radians(pitch_x.min(pitch_y) / (1.0 + a * a + b * b).sqrt());
        Ppd(1.0 / spacing.to_degrees())
    }
}

/// Removes the last rounding errors from entries that are whole numbers, so that a view that shows
/// content pixel for pixel samples exactly at pixel centres.
fn snap(value: f64) -> f64 {
    let whole = libm::round(value);
    if (value - whole).abs() < 1e-9 {
        whole
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::surface::Screen;

    #[test]
    fn a_filling_view_maps_pixels_onto_themselves_exactly() {
        for size in [[1920, 1080], [1281, 721], [33, 7]] {
            let surface = Surface::flat(size, Screen::default());
            let view = EyeView::filling(&surface, size);
            assert_eq!(view.content_from_pixel(&surface), DMat3::IDENTITY);
        }
    }

    #[test]
    fn what_fills_the_same_angle_at_the_eye_is_seen_alike_however_far_it_is_zoomed() {
        let size = [1000, 500];
        let at_eye = [0.4, 0.4, 0.2, 0.2];
        for shown in [
            [1.2, 1.2, 0.6, 0.6],
            [0.05, 0.05, 0.025, 0.025],
            [-0.3, 0.5, -0.1, 0.2],
        ] {
            let field = Field {
                at_eye: Some(at_eye),
                ..Field::of(shown)
            };
            assert!(field.is_open());
            let view = EyeView {
                position: Default::default(),
                axes: Axes::FRONT,
                field,
                size,
                eye: Eye::Left,
            };
            let corner = view.ray([0.0, 0.0]).normalize();
            let seen = view.seen_direction(corner).unwrap();
            assert!((seen - Axes::FRONT.at([-0.4, -0.2]).normalize()).length() < 1e-12);
            // A display pixel of the content is a display pixel at the eye.
            let ppd = view.seen_ppd(view.ppd_towards(corner), corner);
            assert!((ppd.0 / view.as_seen().ppd_towards(seen).0 - 1.0).abs() < 1e-12);
            assert_eq!(view.seen_direction(DVec3::Z), None);
        }
        assert!(!Field::of([-0.5, 0.5, 0.1, 0.1]).is_open());
    }

    #[test]
    fn without_another_angle_at_the_eye_nothing_is_changed() {
        let surface = Surface::flat([640, 480], Screen::default());
        let view = EyeView::filling(&surface, [640, 480]);
        assert_eq!(view.seen_direction(DVec3::Z), Some(DVec3::Z));
        assert_eq!(view.seen_ppd(Ppd(3.0), DVec3::X), Ppd(3.0));
        assert_eq!(view.as_seen(), view);
    }

    #[test]
    fn a_ray_comes_back_to_its_pixel() {
        let size = [640, 480];
        let view = EyeView {
            position: Default::default(),
            axes: Axes::from_yaw_pitch_roll(Radians(0.4), Radians(-0.2), Radians(0.1)),
            field: Field::across(Radians(1.7), size),
            size,
            eye: Eye::Left,
        };
        for place in [[0.5, 0.5], [320.0, 240.0], [639.5, 13.5]] {
            let back = view.place(view.ray(place).normalize()).unwrap();
            assert!((back[0] - place[0]).abs() < 1e-9 && (back[1] - place[1]).abs() < 1e-9);
        }
    }
}
