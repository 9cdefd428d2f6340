//! How do the top and bottom faces get their samples?
//!
//! Rows of the source are circles there. The filter works along longitude and latitude, stretched
//! along longitude by the reciprocal of the distance from the pole, up to the rim of the polar cap;
//! inside it, where circles bend under the kernel, [`super::cap`] weighs every sample by its place on
//! the face. Both faces are mirror images of each other and share their weights.

use super::cap::Cap;
use super::kernel::{Kernel, Taps, code_value, dot_bytes, keep_six_bits};
use super::plane::Plane;
use std::f64::consts::PI;
use std::ops::Range;

/// A range of rows of the top face, and the same of the bottom face counted from its last row up,
/// each row by row.
pub(super) fn pole_rows(
    plane: &Plane,
    kernel: &Kernel,
    caps: &[Cap; 2],
    rows: Range<usize>,
) -> [Vec<u8>; 2] {
    let mut out = [0, 1].map(|_| Vec::with_capacity(rows.len() * plane.face));
    let [mut along, mut down] = [Taps::default(), Taps::default()];
    let columns_per_step = plane.width as f64 / PI / plane.face as f64;
    for j in rows {
        let b = plane.tangent(j);
        for i in 0..plane.face {
            let a = plane.tangent(i);
            let radius = (a * a + b * b).sqrt();
            if radius < plane.cap_radius() {
                for (out, cap) in out.iter_mut().zip(caps) {
                    out.push(cap.at(kernel, a, b));
                }
                continue;
            }
            let column = plane.column(libm::atan2(a, b));
            let stretch = (columns_per_step / radius).max(1.0);
            let first_column = kernel.weigh(column, stretch, &mut along);
            let stretch = (plane.rows_per_step() / (1.0 + radius * radius)).max(1.0);
            let first_row = kernel.weigh(plane.row(libm::atan(radius)), stretch, &mut down);
            for (pole, out) in out.iter_mut().enumerate() {
                let sum = sum_rows(plane, pole, [first_column, first_row], &along, &down);
                out.push(code_value(sum));
            }
        }
    }
    out
}

/// Weighted sum of samples in 2^-20 code values, rows counted from the pole.
#[inline]
fn sum_rows(plane: &Plane, pole: usize, first: [i64; 2], along: &Taps, down: &Taps) -> i32 {
    let mut sum = 0;
    for (row, &weight) in (first[1]..).zip(&down.fixed) {
        let row = (row.max(0) as usize).min(plane.height - 1);
        let row = if pole == 0 {
            row
        } else {
            plane.height - 1 - row
        };
        let samples = plane.taps(row, first[0], along.fixed.len());
        sum += keep_six_bits(dot_bytes(samples, &along.fixed)) * i32::from(weight);
    }
    sum
}
