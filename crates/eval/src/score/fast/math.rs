//! What are logarithms, powers and angles in single precision, many at a time?
//!
//! Without branches or tables, so that a loop over a row becomes vector instructions.

use std::f32::consts::{LN_2, LOG2_E};

/// 1.5 x 2^23: what is added to it is rounded to a whole number in the lowest bits.
const ROUNDER: f32 = 12_582_912.0;
/// The bits of the root of a half: mantissas are taken from there to the root of two.
const ROOT_HALF: u32 = 0x3f35_04f3;
/// Octaves beyond which a number is 0 or infinite.
const MOST_OCTAVES: f32 = 126.0;

/// Log2 of a normal number above 0, within 2e-7 of the larger of 1 and the result.
#[inline(always)]
pub(super) fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let octave = (bits.wrapping_sub(ROOT_HALF) as i32) >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub((octave as u32) << 23));
    // The series of the area hyperbolic tangent.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let s2 = s * s;
    let series = 1.0 + s2 * (1.0 / 3.0 + s2 * (1.0 / 5.0 + s2 * (1.0 / 7.0 + s2 * (1.0 / 9.0))));
    octave as f32 + s * (2.0 * LOG2_E) * series
}

/// 2 to a power, within 2e-7 of the result; constant beyond 126 octaves.
#[inline(always)]
pub(super) fn exp2(x: f32) -> f32 {
    let x = x.clamp(-MOST_OCTAVES, MOST_OCTAVES);
    let shifted = x + ROUNDER;
    let whole = shifted - ROUNDER;
    let y = (x - whole) * LN_2;
    let tail = 1.0 / 24.0 + y * (1.0 / 120.0 + y * (1.0 / 720.0 + y * (1.0 / 5040.0)));
    let series = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * tail)));
    let octave = shifted.to_bits().wrapping_sub(ROUNDER.to_bits());
    series * f32::from_bits(octave.wrapping_add(127) << 23)
}

/// The whole number below a place in a table, and what is left: from 0 to 1, both included.
#[inline(always)]
pub(super) fn split(place: f32) -> (u32, f32) {
    let shifted = (place - 0.5).max(0.0) + ROUNDER;
    let whole = shifted - ROUNDER;
    (
        shifted.to_bits().wrapping_sub(ROUNDER.to_bits()),
        place - whole,
    )
}

/// Angle of a tangent from 0 to 1 in radians, within 4e-8: Abramowitz and Stegun 1964, 4.4.49.
#[inline(always)]
pub(super) fn atan(x: f32) -> f32 {
    const SERIES: [f32; 8] = [
        -0.333_331_45,
        0.199_935_51,
        -0.142_089,
        0.106_562_64,
        -0.075_289_64,
        0.042_909_614,
        -0.016_165_737,
        0.002_866_226,
    ];
    let x2 = x * x;
    let mut sum = SERIES[7];
    sum = sum * x2 + SERIES[6];
    sum = sum * x2 + SERIES[5];
    sum = sum * x2 + SERIES[4];
    sum = sum * x2 + SERIES[3];
    sum = sum * x2 + SERIES[2];
    sum = sum * x2 + SERIES[1];
    sum = sum * x2 + SERIES[0];
    x * (1.0 + x2 * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_and_powers_are_those_of_the_platform() {
        for step in -1200..1200 {
            let octaves = step as f32 * 0.1;
            let power = f64::from(octaves).exp2();
            let found = f64::from(exp2(octaves));
            assert!((found / power - 1.0).abs() < 3e-7, "{octaves}: {found}");
            let x = power as f32;
            let wanted = f64::from(x).log2();
            let found = f64::from(log2(x));
            let most = 3e-7 * wanted.abs().max(1.0);
            assert!((found - wanted).abs() < most, "{x}: {found} {wanted}");
        }
        assert!(exp2(-1e9) > 0.0 && exp2(1e9).is_finite());
    }

    #[test]
    fn angles_are_those_of_the_platform() {
        for step in 0..=1000 {
            let x = step as f32 / 1000.0;
            let wanted = f64::from(x).atan();
            assert!((f64::from(atan(x)) - wanted).abs() < 1e-7, "{x}");
        }
    }

    #[test]
    fn a_place_falls_between_its_entries() {
        for step in 0..=310 {
            let place = step as f32 / 10.0;
            let (low, share) = split(place);
            assert!(
                low <= 30 && (0.0..=1.0).contains(&share),
                "{place}: {low} {share}"
            );
            assert!((low as f32 + share - place).abs() < 1e-6);
        }
    }
}
