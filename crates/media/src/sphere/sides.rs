//! How do the four upright faces get their samples?
//!
//! A column of an upright face has one longitude, so the filter is exactly separable: first along
//! each row of the source to that longitude, then down the column. The latitudes of a column are
//! the same on all four faces and in the column mirrored left to right: eight samples share their
//! weights.

use super::block::Block;
use super::kernel::{Kernel, LANES, REACH, Taps, code_value, dot, keep_six_bits};
use super::plane::Plane;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// Source rows filtered before moving on to the next column, so that writes stay near each other.
const BLOCK: usize = 16;

/// A range of columns of the left half of the front face, and of the seven halves like it.
pub(super) fn side_blocks(plane: &Plane, kernel: &Kernel, columns: Range<usize>) -> Vec<Block> {
    let rows = rows_needed(plane, &columns);
    let mirrored = plane.face - columns.end..plane.face - columns.start;
    let mut strips = Vec::with_capacity(8);
    for face in 0..4 {
        for (columns, mirrored) in [(&columns, false), (&mirrored, true)] {
            let weighed = weigh_columns(plane, kernel, face, columns);
            strips.push(Strip {
                mirrored,
                along: filter_rows(plane, &weighed, &rows),
                block: Block {
                    face,
                    at: [columns.start, 0],
                    width: columns.len(),
                    samples: vec![0; columns.len() * plane.face],
                },
            });
        }
    }
    filter_columns(plane, kernel, &mut strips, &columns, &rows);
    strips.into_iter().map(|strip| strip.block).collect()
}

/// Some columns of a face on their way.
struct Strip {
    /// Whether the last column is the one like the first of the front face's strip.
    mirrored: bool,
    /// The columns at the source's latitudes.
    along: Vec<i16>,
    block: Block,
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

/// First source column and weights of each column of a face.
fn weigh_columns(
    plane: &Plane,
    kernel: &Kernel,
    face: usize,
    columns: &Range<usize>,
) -> Vec<(usize, Vec<i16>)> {
    let weigh = |i| {
        let a = plane.tangent(i);
        let yaw = libm::atan(a) + face as f64 * FRAC_PI_2;
        let mut taps = Taps::default();
        let first = kernel.weigh(plane.column(yaw), plane.yaw_stretch(a), &mut taps);
        (plane.wrapped(first), taps.fixed)
    };
    columns.clone().map(weigh).collect()
}

/// The longitudes of the columns out of each source row: column by column, in 64ths of a code
/// value, with room behind each column for a whole vector.
fn filter_rows(plane: &Plane, weighed: &[(usize, Vec<i16>)], rows: &Range<usize>) -> Vec<i16> {
    let stride = rows.len() + room(plane);
    let mut along = vec![0; stride * weighed.len()];
    for start in rows.clone().step_by(BLOCK) {
        let end = (start + BLOCK).min(rows.end);
        for ((first, taps), out) in weighed.iter().zip(along.chunks_exact_mut(stride)) {
            for row in start..end {
                let sum = dot(plane.taps(row, *first, taps.len()), taps);
                out[row - rows.start] = keep_six_bits(sum) as i16;
            }
        }
    }
    // Beyond the last row, which only tiny pictures reach, the border repeats.
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

/// The face samples out of the filtered columns.
fn filter_columns(
    plane: &Plane,
    kernel: &Kernel,
    strips: &mut [Strip],
    columns: &Range<usize>,
    rows: &Range<usize>,
) {
    let stride = rows.len() + room(plane);
    let width = columns.len();
    let mut taps = Taps::default();
    for (x, i) in columns.clone().enumerate() {
        let a = plane.tangent(i);
        let cos = 1.0 / (1.0 + a * a).sqrt();
        for j in 0..plane.face {
            let b = plane.tangent(j);
            let slope = b * cos;
            let position = plane.row(FRAC_PI_2 + libm::atan(slope));
            let density = plane.rows_per_step() * plane.slope(b);
            let stretch = (density * cos / (1.0 + slope * slope)).max(1.0);
            let first = kernel.weigh(position, stretch, &mut taps) - rows.start as i64;
            let first = (first.max(0) as usize).min(stride - taps.fixed.len());
            for strip in strips.iter_mut() {
                let x = if strip.mirrored { width - 1 - x } else { x };
                let column = &strip.along[x * stride + first..];
                strip.block.samples[j * width + x] = code_value(dot(column, &taps.fixed));
            }
        }
    }
}
