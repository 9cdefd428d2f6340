//! How is one plane of an equirectangular picture read across its borders?

use super::coverage::Coverage;
use super::kernel::{Kernel, LANES, REACH};
use foveal_core::view::surface::Mapping;
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
    /// How those samples lie over its angles.
    mapping: Mapping,
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
        mapping: Mapping,
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
            mapping,
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
        let place = (index as f64 + 0.5) * 2.0 / self.face as f64 - 1.0;
        self.mapping.tangent(place)
    }

    /// Change of the tangent with the place, over what it is on gnomonic faces.
    #[inline]
    pub(super) fn slope(&self, tangent: f64) -> f64 {
        self.mapping.slope(tangent)
    }

    /// The same away from the pole and round it, at a place of a face that looks at a pole.
    pub(super) fn pole_slopes(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        let [across, down] = [a, b].map(|tangent| self.slope(tangent));
        let radius = (a * a + b * b).sqrt();
        if radius == 0.0 {
            return [across, down];
        }
        let [a, b] = [a / radius, b / radius];
        let length = |x: f64, y: f64| (x * x + y * y).sqrt();
        [length(across * a, down * b), length(across * b, down * a)]
    }

    /// Face samples from the middle of a face to a tangent, on one axis.
    pub(super) fn samples_from_middle(&self, tangent: f64) -> f64 {
        self.mapping.place(tangent) * self.face as f64 / 2.0
    }

    /// Face samples in a unit of the tangent plane at the pole.
    pub(super) fn samples_at_pole(&self) -> f64 {
        self.face as f64 / 2.0 / self.slope(0.0)
    }

    /// Columns a face sample at horizontal tangent `a` of an upright face, at least one.
    pub(super) fn yaw_stretch(&self, a: f64) -> f64 {
        (self.columns_per_step() * self.slope(a) / (1.0 + a * a)).max(1.0)
    }

    /// Columns a unit of the tangent plane is multiplied with to give columns a face sample.
    pub(super) fn columns_per_step(&self) -> f64 {
        self.width as f64 / PI / self.face as f64
    }

    /// Rows a unit of the tangent plane is multiplied with to give rows a face sample.
    pub(super) fn rows_per_step(&self) -> f64 {
        self.height as f64 * 2.0 / PI / self.face as f64
    }

    /// How much wider than a face sample the kernel must be in the cap so as not to fall between
    /// rows, which lie up to 1.15 times as far apart at its rim as at the pole.
    pub(super) fn pole_stretch(&self) -> f64 {
        (1.15 / (self.rows_per_step() * self.slope(0.0))).max(1.0)
    }

    /// Radius around a pole, in tangents, within which the grid of longitudes bends too much under
    /// a kernel, so that [`super::cap`] takes over.
    pub(super) fn cap_radius(&self) -> f64 {
        let sample = self.pole_stretch() / self.samples_at_pole();
        (CAP * sample).min(WIDEST_CAP).max(SMALLEST_CAP * sample)
    }

    /// Columns a face sample at the border of the cap: the most that any kernel outside it spans.
    fn yaw_stretch_at_cap(&self) -> f64 {
        self.columns_per_step() / self.cap_radius()
    }
}

/// Radius of the polar cap in face samples: an arc of [`REACH`] samples bends by 0.75 there.
const CAP: f64 = 4.0 * REACH;

/// Most radius in tangents: farther out rows lie too far apart on the face for a kernel of one
/// size.
const WIDEST_CAP: f64 = 0.3;

/// Least radius in face samples, so that no kernel outside the cap reaches the pole.
const SMALLEST_CAP: f64 = REACH + 2.0;
