//! How is one plane of an equirectangular picture read across its borders?

use super::Coverage;
use super::kernel::{Kernel, LANES, REACH};
use std::f64::consts::{PI, TAU};

/// One plane with every column that a kernel may ask for: the turn closed, and for half a sphere
/// the rest of the turn filled with the nearest column.
pub(super) struct Plane {
    samples: Vec<u8>,
    stride: usize,
    /// Columns of a whole turn.
    pub(super) width: usize,
    /// Rows from pole to pole.
    pub(super) height: usize,
    /// Columns left of yaw 0.
    centre: f64,
    /// Samples on a side of this plane's cube face.
    pub(super) face: usize,
}

impl Plane {
    /// The plane of `size` samples; `shift` is how far right of their place its samples count, in
    /// columns.
    pub(super) fn new(
        plane: &[u8],
        size: [u32; 2],
        coverage: Coverage,
        shift: f64,
        face: usize,
    ) -> Self {
        let [given, height] = size.map(|n| n as usize);
        let (width, left) = match coverage {
            Coverage::Full => (given, 0),
            Coverage::FrontHalf => (2 * given, given / 2),
        };
        let mut this = Self {
            samples: Vec::new(),
            stride: 0,
            width,
            height,
            centre: left as f64 + given as f64 / 2.0 + shift,
            face,
        };
        let most = this.yaw_stretch(0.0).max(this.yaw_stretch_at_cap());
        this.stride = width + Kernel::most_taps(most) + LANES;
        this.samples.reserve_exact(this.stride * height);
        for row in plane.chunks_exact(given) {
            let start = this.samples.len();
            this.samples.resize(start + left, row[0]);
            this.samples.extend_from_slice(row);
            // Half of what is beyond continues the right border, half the left one, to meet behind.
            let rest = width - left - given;
            this.samples
                .resize(start + left + given + rest, row[given - 1]);
            for column in width..this.stride {
                this.samples.push(this.samples[start + column - width]);
            }
        }
        this
    }

    /// `count` samples of a row from a [`Self::wrapped`] column on.
    #[inline]
    pub(super) fn taps(&self, row: usize, column: usize, count: usize) -> &[u8] {
        &self.samples[row * self.stride + column..][..count]
    }

    /// The same column within the first turn.
    #[inline]
    pub(super) fn wrapped(&self, column: i64) -> usize {
        column.rem_euclid(self.width as i64) as usize
    }

    /// All rows, and how far apart they begin.
    #[inline]
    pub(super) fn rows(&self) -> (&[u8], usize) {
        (&self.samples, self.stride)
    }

    /// One turn of a row.
    pub(super) fn turn(&self, row: usize) -> &[u8] {
        &self.samples[row * self.stride..][..self.width]
    }

    /// Fractional column index of a yaw.
    #[inline]
    pub(super) fn column(&self, yaw: f64) -> f64 {
        self.centre + yaw * (self.width as f64 / TAU) - 0.5
    }

    /// Fractional row index of an angle from the upper pole.
    #[inline]
    pub(super) fn row(&self, from_pole: f64) -> f64 {
        from_pole * (self.height as f64 / PI) - 0.5
    }

    /// Tangent-plane place of sample `index` of the face.
    #[inline]
    pub(super) fn tangent(&self, index: usize) -> f64 {
        (index as f64 + 0.5) * 2.0 / self.face as f64 - 1.0
    }

    /// Columns a face sample at horizontal tangent `a` of an upright face, at least one.
    pub(super) fn yaw_stretch(&self, a: f64) -> f64 {
        (self.width as f64 / PI / self.face as f64 / (1.0 + a * a)).max(1.0)
    }

    /// Rows a unit of the tangent plane is multiplied with to give rows a face sample.
    pub(super) fn rows_per_step(&self) -> f64 {
        self.height as f64 * 2.0 / PI / self.face as f64
    }

    /// How much wider than a face sample the kernel must be in the cap so as not to fall between
    /// rows, which lie up to 1.15 times as far apart at its rim as at the pole.
    pub(super) fn pole_stretch(&self) -> f64 {
        (1.15 / self.rows_per_step()).max(1.0)
    }

    /// Radius around a pole, in tangents, within which the grid of longitudes bends too much under
    /// a kernel, so that [`super::cap`] takes over.
    pub(super) fn cap_radius(&self) -> f64 {
        let sample = self.pole_stretch() * 2.0 / self.face as f64;
        (CAP * sample).min(WIDEST_CAP).max(SMALLEST_CAP * sample)
    }

    /// Columns a face sample at the border of the cap: the most that any kernel outside it spans.
    fn yaw_stretch_at_cap(&self) -> f64 {
        self.width as f64 / PI / self.face as f64 / self.cap_radius()
    }
}

/// Radius of the polar cap in face samples: an arc of [`REACH`] samples bends by 0.75 there.
const CAP: f64 = 4.0 * REACH;

/// Most radius in tangents: farther out rows lie too far apart on the face for a kernel of one
/// size.
const WIDEST_CAP: f64 = 0.3;

/// Least radius in face samples, so that no kernel outside the cap reaches the pole.
const SMALLEST_CAP: f64 = REACH + 2.0;
