//! Which place of the source does a pixel of a panel show, and how does that move with the pixel?

use super::distortion::GREEN;
use super::placement::{Placement, SourceProjection};
use super::rig::Panel;
use glam::{DMat3, DVec3};

/// A panel's view of a source.
#[derive(Clone, Copy, Debug)]
pub struct PixelMap<'a> {
    /// Who looks.
    pub panel: &'a Panel,
    /// Where the source lies.
    pub placement: &'a Placement,
    /// Columns and rows of the source.
    pub size: [u32; 2],
}

/// What a place of a panel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedPixel {
    /// Column and row of the source.
    pub place: [f64; 2],
    /// Rows: the change of the source's column, and of its row, with the panel's column and row.
    pub jacobian: [[f64; 2]; 2],
}

/// The ray of a place of a panel and its change with the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelRay {
    /// World ray, of any length.
    pub ray: DVec3,
    /// Its change with the column, and with the row.
    pub change: [DVec3; 2],
}

impl Panel {
    /// The ray of a place, through its optics, with its change; `None` where it is unlit.
    #[must_use]
    pub fn ray_at(&self, place: [f64; 2], channel: usize) -> Option<PanelRay> {
        let bent = self.distortion.ideal(&self.view, place, channel)?;
        let m = self.view.ray_from_pixel();
        let [[xx, xy], [yx, yy]] = bent.jacobian;
        Some(PanelRay {
            ray: m * DVec3::new(bent.place[0], bent.place[1], 1.0),
            change: [m.x_axis * xx + m.y_axis * yx, m.x_axis * xy + m.y_axis * yy],
        })
    }
}

impl PanelRay {
    /// The place of a source in the window's own units, with its change.
    #[must_use]
    pub fn coordinates(&self, placement: &Placement) -> Option<MappedPixel> {
        let found = placement.coordinates(self.ray)?;
        Some(MappedPixel {
            place: found.place,
            jacobian: found.change.map(|row| self.change.map(|it| row.dot(it))),
        })
    }
}

impl PixelMap<'_> {
    /// What a place of the panel shows; `None` where it looks behind the source, or is unlit.
    #[must_use]
    pub fn at(&self, place: [f64; 2]) -> Option<MappedPixel> {
        self.of_channel(place, GREEN)
    }

    /// The same of red (0), green (1) or blue (2).
    #[must_use]
    pub fn of_channel(&self, place: [f64; 2], channel: usize) -> Option<MappedPixel> {
        let ray = self.panel.ray_at(place, channel)?;
        let found = self.placement.place_of(ray.ray, self.size)?;
        Some(MappedPixel {
            place: found.place,
            jacobian: found.change.map(|row| ray.change.map(|it| row.dot(it))),
        })
    }

    /// What pixel (column, row) shows, at its centre.
    #[must_use]
    pub fn of_pixel(&self, pixel: [u32; 2]) -> Option<MappedPixel> {
        self.at(pixel.map(|it| f64::from(it) + 0.5))
    }
}

/// The matrix from (column, row, 1) of the ideal panel to the homogeneous place in a plane of
/// `size` pixels; `None` for any other source. The place is good where the last row is positive.
#[must_use]
pub fn homography(panel: &Panel, placement: &Placement, size: [u32; 2]) -> Option<DMat3> {
    if placement.projection != SourceProjection::Plane {
        return None;
    }
    let [left, _, up, _] = placement.window;
    let extent = placement.extent();
    let [kx, ky] = [0, 1].map(|k| f64::from(size[k]) / extent[k]);
    let axes = placement.axes;
    let row_x = (axes.right + axes.forward * left) * kx;
    let row_y = (axes.down + axes.forward * up) * ky;
    let place_from_ray = DMat3::from_cols(row_x, row_y, axes.forward).transpose();
    // The eye of a near source: e (d . forward) + d (1 - e . forward).
    let (eye, forward) = (placement.eye, axes.forward);
    let sheared = DMat3::from_cols(eye * forward.x, eye * forward.y, eye * forward.z);
    let straight = DMat3::from_diagonal(DVec3::splat(1.0 - eye.dot(forward)));
    Some(place_from_ray * (sheared + straight) * panel.view.ray_from_pixel())
}

impl MappedPixel {
    /// The largest and the smallest factor by which a step on the panel grows in the source: the
    /// singular values of the Jacobian.
    #[must_use]
    pub fn sigma(&self) -> [f64; 2] {
        singular_values(self.jacobian)
    }
}

/// The largest and the smallest singular value of a matrix.
///
/// The small one is the determinant over the large one: of the difference of squares nothing would
/// be left where it is tiny.
#[must_use]
pub fn singular_values([[ux, uy], [vx, vy]]: [[f64; 2]; 2]) -> [f64; 2] {
    let (a, b, c) = (ux * ux + uy * uy, ux * vx + uy * vy, vx * vx + vy * vy);
    let half = (a - c) / 2.0;
    let largest = ((a + c) / 2.0 + (half * half + b * b).sqrt()).sqrt();
    let area = (ux * vy - uy * vx).abs();
    [largest, if largest > 0.0 { area / largest } else { 0.0 }]
}
