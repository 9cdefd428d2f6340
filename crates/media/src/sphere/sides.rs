//! How do the four upright faces get their samples?
//!
//! A column of an upright face has one longitude, so the filter is exactly separable: first along
//! each row of the source to that longitude, then down the column. The latitudes of a column are the
//! same on all four faces, which therefore share their weights.

use super::kernel::{Kernel, LANES, REACH, Taps, code_value, dot_bytes, dot_words, keep_six_bits};
use super::plane::Plane;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// Source rows filtered before moving on to the next column, so that writes stay near each other.
const BLOCK: usize = 16;

/// A range of columns of the four upright faces, row by row.
pub(super) fn side_strips(plane: &Plane, kernel: &Kernel, columns: Range<usize>) -> [Vec<u8>; 4] {
    let rows = rows_needed(plane, &columns);
    let along = [0, 1, 2, 3].map(|face| filter_rows(plane, kernel, face, &columns, &rows));
    filter_columns(plane, kernel, &along, &columns, &rows)
}

/// Source rows under the columns, kernel included.
fn rows_needed(plane: &Plane, columns: &Range<usize>) -> Range<usize> {
    let nearest = columns
        .clone()
        .map(|i| plane.tangent(i).abs())
        .fold(1.0, f64::min);
    let pitch = libm::atan(1.0 / (1.0 + nearest * nearest).sqrt());
    let margin = REACH * plane.rows_per_step().max(1.0) + 2.0;
    let first = plane.row(FRAC_PI_2 - pitch) - margin;
    let last = plane.row(FRAC_PI_2 + pitch) + margin;
    first.max(0.0) as usize..(last.ceil() as usize).min(plane.height)
}

/// The longitudes of the columns out of each source row: column by column, in 64ths of a code
/// value, with room behind each column for a whole vector.
fn filter_rows(
    plane: &Plane,
    kernel: &Kernel,
    face: usize,
    columns: &Range<usize>,
    rows: &Range<usize>,
) -> Vec<i16> {
    let weighed: Vec<(i64, Vec<i16>)> = columns
        .clone()
        .map(|i| {
            let a = plane.tangent(i);
            let yaw = libm::atan(a) + face as f64 * FRAC_PI_2;
            let mut taps = Taps::default();
            let first = kernel.weigh(plane.column(yaw), plane.yaw_stretch(a), &mut taps);
            (first, taps.fixed)
        })
        .collect();
    let stride = rows.len() + room(plane);
    let mut along = vec![0; stride * columns.len()];
    for start in rows.clone().step_by(BLOCK) {
        let end = (start + BLOCK).min(rows.end);
        for ((first, taps), out) in weighed.iter().zip(along.chunks_exact_mut(stride)) {
            for row in start..end {
                let sum = dot_bytes(plane.taps(row, *first, taps.len()), taps);
                out[row - rows.start] = keep_six_bits(sum) as i16;
            }
        }
    }
    // Beyond the first and last row, which only tiny pictures reach, the border repeats.
    for out in along.chunks_exact_mut(stride) {
        let last = out[rows.len() - 1];
        out[rows.len()..].fill(last);
    }
    along
}

/// Most samples that a kernel may read behind the last row.
fn room(plane: &Plane) -> usize {
    Kernel::most_taps(plane.rows_per_step().max(1.0)) + LANES
}

/// The face samples out of the filtered columns, row by row.
fn filter_columns(
    plane: &Plane,
    kernel: &Kernel,
    along: &[Vec<i16>; 4],
    columns: &Range<usize>,
    rows: &Range<usize>,
) -> [Vec<u8>; 4] {
    let stride = rows.len() + room(plane);
    let width = columns.len();
    let mut strips = [0, 1, 2, 3].map(|_| vec![0; width * plane.face]);
    let mut taps = Taps::default();
    for (x, i) in columns.clone().enumerate() {
        let a = plane.tangent(i);
        let cos = 1.0 / (1.0 + a * a).sqrt();
        for j in 0..plane.face {
            let slope = plane.tangent(j) * cos;
            let position = plane.row(FRAC_PI_2 + libm::atan(slope));
            let stretch = (plane.rows_per_step() * cos / (1.0 + slope * slope)).max(1.0);
            let first = kernel.weigh(position, stretch, &mut taps) - rows.start as i64;
            let first = first.max(0) as usize;
            for (strip, along) in strips.iter_mut().zip(along) {
                let column = &along[x * stride..][..stride];
                let sum = dot_words(&column[first.min(stride - taps.fixed.len())..], &taps.fixed);
                strip[j * width + x] = code_value(sum);
            }
        }
    }
    strips
}
