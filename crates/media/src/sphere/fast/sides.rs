//! How do the four upright faces get their samples, fast?
//!
//! A column of a face lies on one meridian, so columns are filtered first, each with one kernel
//! for all rows and all four faces; then every sample of a column has a kernel of its own. The
//! source is transposed strip by strip, so that both steps read samples that lie side by side.

use super::super::block::{Block, STRIP};
use super::super::plane::Plane;
use super::cubic::{
    BEFORE, Cubic, ENTRY_BITS, INNER, PHASE_BITS, PHASES, TAPS, code_value, entry, sample_of,
    steps, sum_inner, width_index,
};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;
use wide::i16x8;

/// Rows that are transposed at once.
const TRANSPOSED: usize = 16;

/// Where the samples of an upright face look.
pub(super) struct SidePlaces {
    face: usize,
    width: usize,
    height: usize,
    /// Of the front face's columns: 64ths of a source column, and the widening.
    columns: Vec<(i64, u8)>,
    /// Of its samples, column by column, the left half: first row under the kernel, counted from
    /// [`Self::first_row`], and the kernel's entry.
    rows: Vec<u32>,
    first_row: i64,
    row_count: usize,
}

impl SidePlaces {
    pub(super) fn new(plane: &Plane) -> Self {
        let face = plane.face;
        let tangents: Vec<f64> = (0..face).map(|i| plane.tangent(i)).collect();
        let column = |a: &f64| {
            let stretch = plane.yaw_stretch(*a);
            (steps(plane.column(libm::atan(*a))), width_index(stretch))
        };
        let row = |a: f64, b: f64| {
            let cos = 1.0 / (1.0 + a * a).sqrt();
            let slope = b * cos;
            let density = plane.rows_per_step() * plane.slope(b);
            let stretch = (density * cos / (1.0 + slope * slope)).max(1.0);
            let place = steps(plane.row(FRAC_PI_2 + libm::atan(slope)));
            (place, width_index(stretch))
        };
        let left = &tangents[..face.div_ceil(2)];
        let places: Vec<(i64, u8)> = left
            .iter()
            .flat_map(|a| tangents.iter().map(move |b| row(*a, *b)))
            .collect();
        let first_of = |place: i64| (place >> PHASE_BITS) - BEFORE;
        let firsts = || places.iter().map(|(place, _)| first_of(*place));
        let first_row = firsts().min().unwrap_or_default();
        let last_row = firsts().max().unwrap_or_default() + TAPS as i64;
        let packed = |(place, width): &(i64, u8)| {
            ((first_of(*place) - first_row) as u32) << ENTRY_BITS | entry(*place, *width) as u32
        };
        Self {
            face,
            width: plane.width,
            height: plane.height,
            columns: tangents.iter().map(column).collect(),
            rows: places.iter().map(packed).collect(),
            first_row,
            row_count: (last_row - first_row) as usize,
        }
    }

    /// The same columns of the four faces.
    pub(super) fn blocks(&self, cubic: &Cubic, plane: &Plane, strip: Range<usize>) -> [Block; 4] {
        let mut source = Vec::new();
        let mut column = vec![0; self.row_count];
        [0, 1, 2, 3].map(|face| {
            // A quarter turn is a whole number of 64ths for any width.
            let turned = self.width as i64 * PHASES / 4 * face as i64;
            let first_of = |x: usize| ((self.columns[x].0 + turned) >> PHASE_BITS) - BEFORE;
            let first = first_of(strip.start);
            let count = (first_of(strip.end - 1) - first) as usize + TAPS;
            self.transpose(plane, first, count, &mut source);
            let mut samples = vec![0; strip.len() * self.face];
            for (x, face_column) in strip.clone().enumerate() {
                let (place, width) = self.columns[face_column];
                let begin = (first_of(face_column) - first) as usize + 1;
                let rows: [&[i16]; INNER] =
                    std::array::from_fn(|k| &source[(begin + k) * self.row_count..]);
                let weights = cubic.at(entry(place + turned, width));
                sum_inner(rows, weights, &mut column);
                let out = samples[x..].iter_mut().step_by(strip.len());
                self.fill_column(cubic, &column, face_column, out);
            }
            Block {
                face,
                at: [strip.start, 0],
                width: strip.len(),
                samples,
            }
        })
    }

    /// Source columns from `first` on, one after the other.
    fn transpose(&self, plane: &Plane, first: i64, count: usize, out: &mut Vec<i16>) {
        out.resize(count * self.row_count, 0);
        let columns: Vec<usize> = (first..).take(count).map(|c| plane.wrapped(c)).collect();
        let last = self.height as i64 - 1;
        for start in (0..self.row_count).step_by(TRANSPOSED) {
            let end = (start + TRANSPOSED).min(self.row_count);
            let row = |k: usize| {
                let row = (self.first_row + (start + k) as i64).clamp(0, last);
                plane.turn(row as usize)
            };
            let rows: [&[u8]; TRANSPOSED] = std::array::from_fn(row);
            for (column, out) in columns.iter().zip(out.chunks_exact_mut(self.row_count)) {
                for (out, row) in out[start..end].iter_mut().zip(rows) {
                    *out = sample_of(row[*column]);
                }
            }
        }
    }

    /// One column of a face out of the filtered column of the source.
    #[inline]
    fn fill_column<'a>(
        &self,
        cubic: &Cubic,
        column: &[i16],
        x: usize,
        out: impl Iterator<Item = &'a mut u8>,
    ) {
        let x = x.min(self.face - 1 - x);
        let places = &self.rows[x * self.face..][..self.face];
        for (out, place) in out.zip(places) {
            let weights = cubic.at((place & ((1 << ENTRY_BITS) - 1)) as usize);
            if let Some(sums) = column[(place >> ENTRY_BITS) as usize..].first_chunk() {
                *out = code_value(i16x8::new(*sums), weights);
            }
        }
    }

    /// Columns of which each part of the work takes some.
    pub(super) fn strips(&self) -> impl Iterator<Item = Range<usize>> {
        let face = self.face;
        (0..face)
            .step_by(2 * STRIP)
            .map(move |start| start..(start + 2 * STRIP).min(face))
    }
}
