//! How does a plane fall into levels, row by row on all cores?
//!
//! The statements of [`crate::score::pyramid`] in single precision, a row at a time.

use super::strip::ROWS;
use crate::score::pyramid::{KERNEL, half_size, mirrored, samples_beyond};
use crate::score::rules::Border;
use foveal_core::perception::fast::instructions::Instructions;
use rayon::prelude::*;

/// The kernel on its two sides.
const K: [f32; 3] = [KERNEL[0] as f32, KERNEL[1] as f32, KERNEL[2] as f32];

/// One plane at every level, finest first.
pub(super) struct Levels {
    pub(super) sizes: Vec<[usize; 2]>,
    pub(super) planes: Vec<Vec<f32>>,
}

impl Levels {
    pub(super) fn new(sizes: &[[usize; 2]]) -> Self {
        Self {
            sizes: sizes.to_vec(),
            planes: sizes.iter().map(|[w, h]| vec![0.0; w * h]).collect(),
        }
    }

    /// Fills every level below the finest.
    pub(super) fn reduce(&mut self, border: Border, instructions: Instructions) {
        for level in 1..self.sizes.len() {
            let size = self.sizes[level - 1];
            let (finer, coarser) = self.planes.split_at_mut(level);
            let step = Reduction {
                fine: &finer[level - 1],
                size,
                beyond: samples_beyond(size, border),
            };
            let columns = half_size(size)[0];
            let strips = coarser[0].par_chunks_mut(columns * ROWS).enumerate();
            strips.for_each(|(strip, out)| {
                instructions.run(
                    #[inline(always)]
                    || step.strip(strip * ROWS, columns, out),
                );
            });
        }
    }

    /// A row of a level expanded to the next finer one. `upright` is as wide as the coarse level.
    #[inline(always)]
    pub(super) fn expand_row(&self, coarse: usize, y: usize, upright: &mut [f32], out: &mut [f32]) {
        let size = self.sizes[coarse];
        expand_row(&self.planes[coarse], size, y, upright, out);
    }
}

/// From one level to the next.
struct Reduction<'a> {
    fine: &'a [f32],
    size: [usize; 2],
    beyond: usize,
}

impl Reduction<'_> {
    /// Rows of the coarser level from `first` on.
    #[inline(always)]
    fn strip(&self, first: usize, columns: usize, out: &mut [f32]) {
        let mut upright = vec![0.0; self.size[0]];
        for (row, out) in out.chunks_exact_mut(columns).enumerate() {
            self.upright(first + row, &mut upright);
            reduce_row(&upright, self.beyond, out);
        }
    }

    #[inline(always)]
    fn upright(&self, y: usize, out: &mut [f32]) {
        let [w, h] = self.size;
        let row = |tap: isize| &self.fine[mirrored(2 * y as isize + tap, h) * w..][..w];
        let [a, b, c, d, e] = [row(-2), row(-1), row(0), row(1), row(2)];
        for (x, out) in out[..w].iter_mut().enumerate() {
            *out = K[0] * (a[x] + e[x]) + K[1] * (b[x] + d[x]) + K[2] * c[x];
        }
    }
}

#[inline(always)]
fn reduce_row(row: &[f32], beyond: usize, out: &mut [f32]) {
    let (w, last) = (row.len(), out.len() - 1);
    let at = |x: isize| row[mirrored(x, w)];
    // All five samples of columns 1 to `last - 1` lie inside.
    if last > 1 {
        let inside = row.windows(5).step_by(2);
        for (out, s) in out[1..last].iter_mut().zip(inside) {
            *out = K[0] * (s[0] + s[4]) + K[1] * (s[1] + s[3]) + K[2] * s[2];
        }
    }
    out[0] = K[0] * (at(-2) + at(2)) + K[1] * (at(-1) + at(1)) + K[2] * at(0);
    let middle = 2 * last as isize;
    let left = K[0] * at(middle - 2) + K[1] * at(middle - 1) + K[2] * at(middle);
    let right = if middle + 1 < w as isize {
        K[1] * row[w - 1]
    } else {
        0.0
    };
    let outside = if beyond == 2 {
        K[1] * row[w - 1] + K[0] * row[w.saturating_sub(2)]
    } else {
        K[0] * row[w - 1]
    };
    out[last] = left + right + outside;
}

/// Row `y` of the next finer level of `coarse`, as wide as `out`.
#[inline(always)]
pub(super) fn expand_row(
    coarse: &[f32],
    [w, h]: [usize; 2],
    y: usize,
    upright: &mut [f32],
    out: &mut [f32],
) {
    let row = |index: usize| &coarse[index.min(h - 1) * w..][..w];
    let at = y / 2;
    let upright = &mut upright[..w];
    if y.is_multiple_of(2) {
        let [a, b, c] = [row(at.saturating_sub(1)), row(at), row(at + 1)];
        for (x, out) in upright.iter_mut().enumerate() {
            *out = 2.0 * (K[0] * (a[x] + c[x]) + K[2] * b[x]);
        }
    } else {
        let [a, b] = [row(at), row(at + 1)];
        for (x, out) in upright.iter_mut().enumerate() {
            *out = 2.0 * K[1] * (a[x] + b[x]);
        }
    }
    widen_row(upright, out);
}

#[inline(always)]
fn widen_row(coarse: &[f32], out: &mut [f32]) {
    let w = coarse.len();
    let even = |a: f32, b: f32, c: f32| 2.0 * (K[0] * (a + c) + K[2] * b);
    let odd = |b: f32, c: f32| 2.0 * K[1] * (b + c);
    let inner = 2.min(out.len());
    for (pair, s) in out[inner..].chunks_exact_mut(2).zip(coarse.windows(3)) {
        pair[0] = even(s[0], s[1], s[2]);
        pair[1] = odd(s[1], s[2]);
    }
    let near = |x: usize| coarse[x.min(w - 1)];
    for x in [0, w - 1] {
        if let Some(out) = out.get_mut(2 * x) {
            *out = even(near(x.saturating_sub(1)), near(x), near(x + 1));
        }
        if let Some(out) = out.get_mut(2 * x + 1) {
            *out = odd(near(x), near(x + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::pyramid::{Plane, expanded, reduced};

    #[test]
    fn levels_are_those_of_the_clear_pyramid() {
        for size in [
            [64, 48],
            [31, 17],
            [30, 17],
            [17, 30],
            [5, 4],
            [4, 5],
            [2, 3],
            [1, 1],
        ] {
            for border in [Border::ByRows, Border::ByColumns] {
                let value = |at: usize| ((at * 7919) % 1009) as f32 / 10.0;
                let fine: Vec<f32> = (0..size[0] * size[1]).map(value).collect();
                let clear = Plane {
                    size,
                    values: fine.iter().map(|v| f64::from(*v)).collect(),
                };
                let coarse = reduced(&clear, border);
                let back = expanded(&coarse, size);
                let mut levels = Levels::new(&[size, half_size(size)]);
                levels.planes[0].copy_from_slice(&fine);
                levels.reduce(border, Instructions::widest());
                for (found, wanted) in levels.planes[1].iter().zip(&coarse.values) {
                    assert!(
                        (f64::from(*found) - wanted).abs() < 1e-4,
                        "{size:?} {border:?}"
                    );
                }
                let (mut upright, mut row) = (vec![0.0; size[0]], vec![0.0; size[0]]);
                for y in 0..size[1] {
                    levels.expand_row(1, y, &mut upright, &mut row);
                    for (found, wanted) in row.iter().zip(&back.values[y * size[0]..]) {
                        assert!((f64::from(*found) - wanted).abs() < 1e-4, "{size:?}");
                    }
                }
            }
        }
    }
}
