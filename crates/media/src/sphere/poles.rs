//! How do the top and bottom faces get their samples?
//!
//! Rows of the source are circles there. The filter works along longitude and latitude, stretched
//! along longitude by the reciprocal of the distance from the pole, up to the rim of the polar cap;
//! inside it, where circles bend under the kernel, [`super::cap`] weighs every sample by its place
//! on the face. Both faces are mirror images of each other, and a quarter turn of a face is a
//! quarter of a row: eight samples share their weights.

use super::block::{BOTTOM, Block, TOP};
use super::cap::Cap;
use super::kernel::{Kernel, Taps, code_value, dot, keep_six_bits};
use super::plane::Plane;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// Rows of the upper left quarter of the top face, and of the seven quarters like it.
pub(super) fn pole_blocks(
    plane: &Plane,
    kernel: &Kernel,
    caps: &[Cap; 2],
    rows: Range<usize>,
) -> Vec<Block> {
    let half = plane.face.div_ceil(2);
    let mut quarters = Vec::with_capacity(8);
    for pole in [TOP, BOTTOM] {
        for turns in 0..4 {
            quarters.push(Quarter::new(
                plane.face,
                pole,
                turns,
                [0..half, rows.clone()],
            ));
        }
    }
    let mut taps = [Taps::default(), Taps::default()];
    for j in rows {
        for i in 0..half {
            let tangent = [plane.tangent(i), plane.tangent(j)];
            fill(
                plane,
                kernel,
                caps,
                tangent,
                &mut taps,
                |pole, turns, sample| {
                    quarters[4 * pole + turns].put([i, j], sample);
                },
            );
        }
    }
    quarters.into_iter().map(|quarter| quarter.block).collect()
}

/// Computes the eight samples that lie like `tangent`: pole, quarter turns, code value.
fn fill(
    plane: &Plane,
    kernel: &Kernel,
    caps: &[Cap; 2],
    [a, b]: [f64; 2],
    [along, down]: &mut [Taps; 2],
    mut put: impl FnMut(usize, usize, u8),
) {
    let radius = (a * a + b * b).sqrt();
    if radius < plane.cap_radius() {
        for (pole, cap) in caps.iter().enumerate() {
            for (turns, [a, b]) in [[a, b], [b, -a], [-a, -b], [-b, a]].into_iter().enumerate() {
                put(pole, turns, cap.at(plane, kernel, a, b));
            }
        }
        return;
    }
    let [away, round] = plane.pole_slopes([a, b]);
    let stretch = (plane.rows_per_step() * away / (1.0 + radius * radius)).max(1.0);
    let row = kernel.weigh(plane.row(libm::atan(radius)), stretch, down);
    let stretch = (plane.columns_per_step() * round / radius).max(1.0);
    let yaw = libm::atan2(a, b);
    let mut column = kernel.weigh(plane.column(yaw), stretch, along);
    for turns in 0..4 {
        if turns > 0 && plane.width.is_multiple_of(4) {
            column += plane.width as i64 / 4;
        } else if turns > 0 {
            let yaw = yaw + turns as f64 * FRAC_PI_2;
            column = kernel.weigh(plane.column(yaw), stretch, along);
        }
        for pole in [0, 1] {
            put(
                pole,
                turns,
                code_value(sum_rows(plane, pole, [column, row], along, down)),
            );
        }
    }
}

/// Weighted sum of samples in 2^-20 code values, rows counted from the pole.
#[inline]
fn sum_rows(plane: &Plane, pole: usize, first: [i64; 2], along: &Taps, down: &Taps) -> i32 {
    let column = plane.wrapped(first[0]);
    let mut sum = 0;
    for (row, &weight) in (first[1]..).zip(&down.fixed) {
        let row = (row.max(0) as usize).min(plane.height - 1);
        let row = if pole == 0 {
            row
        } else {
            plane.height - 1 - row
        };
        let samples = plane.taps(row, column, along.fixed.len());
        sum += keep_six_bits(dot(samples, &along.fixed)) * i32::from(weight);
    }
    sum
}

/// A rectangle of the top face's upper left quarter, turned and mirrored to where it lies.
struct Quarter {
    face_size: usize,
    turns: usize,
    block: Block,
}

impl Quarter {
    fn new(face_size: usize, face: usize, turns: usize, [x, y]: [Range<usize>; 2]) -> Self {
        let first = place([x.start, y.start], face_size, face, turns);
        let last = place([x.end - 1, y.end - 1], face_size, face, turns);
        let [width, height] = [0, 1].map(|k| first[k].abs_diff(last[k]) + 1);
        let at = [0, 1].map(|k| first[k].min(last[k]));
        let block = Block {
            face,
            at,
            width,
            samples: vec![0; width * height],
        };
        Self {
            face_size,
            turns,
            block,
        }
    }

    #[inline]
    fn put(&mut self, pixel: [usize; 2], sample: u8) {
        let [x, y] = place(pixel, self.face_size, self.block.face, self.turns);
        let [left, top] = self.block.at;
        self.block.samples[(y - top) * self.block.width + x - left] = sample;
    }
}

/// Where a pixel of the top face goes by quarter turns, each from yaw 0 towards yaw 90°, and on the
/// bottom face by being mirrored top to bottom after that.
#[inline]
fn place([i, j]: [usize; 2], size: usize, face: usize, turns: usize) -> [usize; 2] {
    let last = size - 1;
    let [x, y] = match turns {
        0 => [i, j],
        1 => [j, last - i],
        2 => [last - i, last - j],
        _ => [last - j, i],
    };
    if face == TOP { [x, y] } else { [x, last - y] }
}
