//! How much do the source samples around a place count?
//!
//! Samples are 16 bits with seven below the point, weights 14 bits. A sum over the first axis keeps
//! five bits below the point, so that it still fits 16.

use wide::{i16x8, u8x16};

/// Steps between two source samples.
pub(super) const PHASES: i64 = 64;
/// Bits of a phase.
pub(super) const PHASE_BITS: u32 = 6;
/// Steps of widening between 1 and 2.
const WIDTHS: usize = 16;
/// Samples under a kernel on one axis.
pub(super) const TAPS: usize = 8;
/// Source samples before the one at or left of a place.
pub(super) const BEFORE: i64 = 3;
/// Widest kernel of which only the [`INNER`] samples count.
pub(super) const WIDEST_INNER: f64 = 1.5;
/// Samples under a kernel that is widened to at most [`WIDEST_INNER`].
pub(super) const INNER: usize = 6;
/// Weights sum up to this: 14 bits.
const ONE: i32 = 1 << 14;
/// What cutting off the products' lower halves loses on average over [`INNER`] samples.
const LOST: i16 = INNER as i16 / 2;

pub(super) type CubicWeights = i16x8;

/// Cubic kernels by widening, then by phase.
pub(super) struct Cubic(Vec<CubicWeights>);

impl Cubic {
    pub(super) fn new() -> Self {
        let mut table = Vec::with_capacity(WIDTHS * PHASES as usize);
        for width in 0..WIDTHS {
            let stretch = 1.0 + width as f64 / WIDTHS as f64;
            for phase in 0..PHASES {
                let place = phase as f64 / PHASES as f64 + BEFORE as f64;
                let at = |tap: usize| catmull_rom((tap as f64 - place) / stretch);
                table.push(normalised([0, 1, 2, 3, 4, 5, 6, 7].map(at)));
            }
        }
        Self(table)
    }

    /// The kernel of an [`entry`].
    #[inline]
    pub(super) fn at(&self, entry: usize) -> &CubicWeights {
        &self.0[entry]
    }
}

/// Bits of an [`entry`].
pub(super) const ENTRY_BITS: u32 = 10;

/// Where the kernel for a place, in 64ths of a sample, and a widening lies in the table.
#[inline]
pub(super) fn entry(place: i64, width: u8) -> usize {
    usize::from(width) << PHASE_BITS | (place & (PHASES - 1)) as usize
}

/// A place in 64ths.
pub(super) fn steps(place: f64) -> i64 {
    (place * PHASES as f64).round() as i64
}

/// Number of the narrowest kernel that is at least so wide.
pub(super) fn width_index(stretch: f64) -> u8 {
    // A stretch of one that arithmetic made a little longer is one.
    (((stretch - 1.0) * WIDTHS as f64 - 1e-6).ceil()).clamp(0.0, WIDTHS as f64 - 1.0) as u8
}

/// Interpolating cubic of Catmull and Rom, zero from 2 on.
pub(crate) fn catmull_rom(x: f64) -> f64 {
    let x = x.abs();
    if x < 1.0 {
        (1.5 * x - 2.5) * x * x + 1.0
    } else if x < 2.0 {
        ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0
    } else {
        0.0
    }
}

/// Fixed point whose sum is exactly [`ONE`].
fn normalised(weights: [f64; TAPS]) -> CubicWeights {
    let sum: f64 = weights.iter().sum();
    let mut fixed = weights.map(|w| (w / sum * f64::from(ONE)).round() as i32);
    let largest = (0..TAPS).max_by_key(|tap| fixed[*tap]).unwrap_or_default();
    fixed[largest] += ONE - fixed.iter().sum::<i32>();
    i16x8::new(fixed.map(|w| w as i16))
}

/// A code value with seven bits below the point.
#[inline]
pub(super) fn sample_of(code: u8) -> i16 {
    i16::from(code) << 7
}

/// The upper half of a product, as vector units give it.
#[inline]
fn upper(a: i16, b: i16) -> i16 {
    ((i32::from(a) * i32::from(b)) >> 16) as i16
}

/// Sums over the first axis: of the inner rows, each by its weight, place by place.
#[inline]
pub(super) fn sum_inner(rows: [&[i16]; INNER], weights: &CubicWeights, out: &mut [i16]) {
    let n = out.len();
    let [r0, r1, r2, r3, r4, r5] = rows.map(|row| &row[..n]);
    let [_, w0, w1, w2, w3, w4, w5, _] = weights.to_array();
    for x in 0..n {
        let outer = upper(r0[x], w0) + upper(r5[x], w5);
        let inner = upper(r1[x], w1) + upper(r4[x], w4);
        out[x] = LOST + outer + inner + upper(r2[x], w2) + upper(r3[x], w3);
    }
}

/// The same of rows of code values that are one kernel wide.
#[inline]
pub(super) fn sum_inner_codes(rows: [&[u8; TAPS]; INNER], weights: &CubicWeights) -> i16x8 {
    let weights = weights.as_array();
    let weighed = |k: usize| {
        let mut codes = [0; 16];
        codes[..TAPS].copy_from_slice(rows[k]);
        let samples: i16x8 = i16x8::from_u8x16_low(u8x16::new(codes)) << 7;
        samples.mul_keep_high(i16x8::splat(weights[k + 1]))
    };
    let (outer, inner) = (weighed(0) + weighed(5), weighed(1) + weighed(4));
    i16x8::splat(LOST) + outer + inner + weighed(2) + weighed(3)
}

/// Code value of the sum over the second axis.
#[inline]
pub(super) fn code_value(sums: i16x8, weights: &CubicWeights) -> u8 {
    let sum = sums.dot(*weights).reduce_add();
    ((sum + (1 << 18)) >> 19).clamp(0, 255) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_kernels_count_only_the_inner_samples() {
        let cubic = Cubic::new();
        for place in 0..PHASES {
            for width in 0..=width_index(WIDEST_INNER) {
                let weights = cubic.at(entry(place, width)).to_array();
                assert_eq!([weights[0], weights[TAPS - 1]], [0, 0]);
                assert_eq!(weights.iter().map(|w| i32::from(*w)).sum::<i32>(), ONE);
            }
        }
    }

    #[test]
    fn every_constant_is_kept_by_every_kernel() {
        let cubic = Cubic::new();
        for code in 0..=255 {
            for down in 0..(usize::from(width_index(WIDEST_INNER)) + 1) << PHASE_BITS {
                let sums = sum_inner_codes([&[code; TAPS]; INNER], cubic.at(down));
                for along in [0, 31, 32 + (15 << PHASE_BITS)] {
                    assert_eq!(code_value(sums, cubic.at(along)), code);
                }
            }
        }
    }
}
