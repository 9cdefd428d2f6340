//! How bright is a texel of the next coarser level?
//!
//! Luma is averaged as light ([`LumaLight`]).

use crate::prepare::pyramid_taps::{REACH, TAPS};
use foveal_core::perception::measures::luma_light::LumaLight;
use std::ops::Range;

/// Binary digits of the sum of [`TAPS`].
const SHIFT: u32 = 5;

/// Some rows of the half of a plane of luma.
pub(crate) fn half_rows(
    table: &LumaLight,
    fine: &[u8],
    size: [u32; 2],
    range: Range<usize>,
) -> Vec<u8> {
    let [w, h] = size.map(|n| n as usize);
    let coarse_w = w.div_ceil(2);
    let mut coarse = vec![0; coarse_w * range.len()];
    if coarse.is_empty() {
        return coarse;
    }
    // The rows that any of these reach, as light.
    let reached = |y: usize, tap: usize| (2 * y + tap).saturating_sub(REACH).min(h - 1);
    let first = reached(range.start, 0);
    let last = reached(range.end - 1, TAPS.len() - 1);
    let codes = &fine[first * w..(last + 1) * w];
    let light: Vec<i32> = codes.iter().map(|c| table.light(*c)).collect();
    // Two texels before the row and up to three after it, always an even number in all.
    let mut column = vec![0i32; 2 * coarse_w + 2 * REACH];
    for (y, out) in range.zip(coarse.chunks_exact_mut(coarse_w)) {
        let rows = [0, 1, 2, 3, 4, 5].map(|tap| {
            let row = reached(y, tap) - first;
            &light[row * w..][..w]
        });
        blend_rows(rows, &mut column[REACH..REACH + w]);
        let (left, right) = (column[REACH], column[REACH + w - 1]);
        column[..REACH].fill(left);
        column[REACH + w..].fill(right);
        for (x, out) in out.iter_mut().enumerate() {
            let near: [i32; 6] = core::array::from_fn(|tap| column[2 * x + tap]);
            *out = table.code(blend(near));
        }
    }
    coarse
}

/// The weighted mean of six lights, no darker or brighter than the middle four: what rings round an
/// edge would be seen, most of all where it is dark.
#[inline]
fn blend([a, b, c, d, e, f]: [i32; 6]) -> i32 {
    let sum = TAPS[0] * (a + f) + TAPS[1] * (b + e) + TAPS[2] * (c + d);
    let mean = (sum + (1 << (SHIFT - 1))) >> SHIFT;
    let least = b.min(c).min(d.min(e));
    let most = b.max(c).max(d.max(e));
    mean.clamp(least, most)
}

/// [`blend`] of six rows at every place.
fn blend_rows(rows: [&[i32]; 6], out: &mut [i32]) {
    let n = out.len();
    let rows = rows.map(|row| &row[..n]);
    for x in 0..n {
        out[x] = blend(rows.map(|row| row[x]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::picture::{Colour, Matrix};
    use proptest::prelude::*;

    const FULL: Colour = Colour {
        matrix: Matrix::Bt709,
        full_range: true,
        chroma_left: false,
    };
    const LIMITED: Colour = Colour {
        full_range: false,
        ..FULL
    };

    fn noise(count: usize, seed: u32) -> Vec<u8> {
        let mut state = seed.wrapping_mul(2_654_435_761) | 1;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..count).map(|_| next()).collect()
    }

    fn half(table: &LumaLight, fine: &[u8], size: [u32; 2]) -> Vec<u8> {
        half_rows(table, fine, size, 0..size[1].div_ceil(2) as usize)
    }

    /// The definition, one texel at a time.
    fn slow_half(table: &LumaLight, fine: &[u8], [w, h]: [u32; 2]) -> Vec<u8> {
        let light = |x: i64, y: i64| {
            let (x, y) = (x.clamp(0, i64::from(w) - 1), y.clamp(0, i64::from(h) - 1));
            table.light(fine[(y * i64::from(w) + x) as usize])
        };
        let six = |at: &dyn Fn(i64) -> i32| blend([-2, -1, 0, 1, 2, 3].map(at));
        let mut coarse = Vec::new();
        for y in 0..i64::from(h.div_ceil(2)) {
            for x in 0..i64::from(w.div_ceil(2)) {
                let column = |along: i64| {
                    let along = (2 * x + along).min(i64::from(w) - 1);
                    six(&|down| light(along, 2 * y + down))
                };
                coarse.push(table.code(six(&column)));
            }
        }
        coarse
    }

    proptest! {
        #[test]
        fn the_fast_half_is_the_slow_one(w in 1u32..70, h in 1u32..40, seed in 0u32..1000) {
            let fine = noise((w * h) as usize, seed);
            for colour in [FULL, LIMITED] {
                let table = LumaLight::of(colour);
                prop_assert_eq!(half(table, &fine, [w, h]), slow_half(table, &fine, [w, h]));
            }
        }

        #[test]
        fn nothing_rings(w in 1u32..40, h in 1u32..40, seed in 0u32..1000) {
            let fine: Vec<u8> = noise((w * h) as usize, seed).iter().map(|s| 90 + s % 80).collect();
            let (least, most) = (fine.iter().min().unwrap(), fine.iter().max().unwrap());
            let coarse = half(LumaLight::of(LIMITED), &fine, [w, h]);
            prop_assert!(coarse.iter().all(|sample| (least..=most).contains(&sample)));
        }
    }

    #[test]
    fn every_code_that_is_shown_stays_itself() {
        for (colour, codes) in [(FULL, 0..=255), (LIMITED, 16..=235)] {
            for code in codes {
                let coarse = half(LumaLight::of(colour), &[code; 12], [4, 3]);
                assert_eq!(coarse, [code; 4], "{colour:?}");
            }
        }
    }

    #[test]
    fn texture_that_is_lost_leaves_its_light() {
        for (colour, [dark, bright]) in [
            (FULL, [40, 200]),
            (LIMITED, [30, 220]),
            (LIMITED, [90, 130]),
        ] {
            let fine: Vec<u8> = (0..64 * 64)
                .map(|k| if k % 2 == 0 { dark } else { bright })
                .collect();
            let table = LumaLight::of(colour);
            let light = |code: u8| f64::from(table.light(code));
            let mean = f64::midpoint(light(dark), light(bright));
            for row in half(table, &fine, [64, 64]).chunks_exact(32) {
                for sample in &row[1..31] {
                    let off = light(*sample) / mean - 1.0;
                    assert!(off.abs() < 0.02, "{dark} and {bright} became {sample}");
                }
            }
        }
    }
}
