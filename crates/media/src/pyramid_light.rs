//! How bright is a texel of the next coarser level?
//!
//! Luma is averaged as light: a mean of code values is darker than what it stands for wherever
//! texture is strong, and the eye sees the darkening of a whole region long after it has lost the
//! texture (docs/decisions/0012-levels-keep-their-light.md).

use super::pyramid::{REACH, TAPS};
use foveal_core::asset::picture::Colour;
use foveal_core::perception::luminance::linear_from_srgb;
use std::ops::Range;
use std::sync::LazyLock;

/// Light of white: 14 bits, so that 6 weighted texels fit into 32 and neighbouring dark codes stay
/// apart.
const WHITE: i32 = (1 << 14) - 1;
/// Binary digits of the sum of [`TAPS`].
const SHIFT: u32 = 5;

/// Light of codes and codes of light.
pub(crate) struct LightTable {
    light: [u16; 256],
    code: Vec<u8>,
}

static FULL_RANGE: LazyLock<LightTable> = LazyLock::new(|| LightTable::new([0.0, 255.0]));
static LIMITED_RANGE: LazyLock<LightTable> = LazyLock::new(|| LightTable::new([16.0, 235.0]));

impl LightTable {
    /// The table of a picture's luma.
    pub(crate) fn of(colour: Colour) -> &'static Self {
        if colour.full_range {
            &FULL_RANGE
        } else {
            &LIMITED_RANGE
        }
    }

    /// For codes of black and white; codes beyond them, which a display does not show, count as
    /// they.
    fn new([black, white]: [f64; 2]) -> Self {
        let light = |code: usize| {
            let share = ((code as f64 - black) / (white - black)).clamp(0.0, 1.0);
            let grey = share * 255.0;
            // The curve between two sRGB codes is nearly straight.
            let [below, above] = [grey.floor(), grey.ceil()].map(|k| linear_from_srgb(k as u8));
            (below + (above - below) * grey.fract()) * f64::from(WHITE)
        };
        let exact: [f64; 256] = core::array::from_fn(light);
        let light = exact.map(|light| light.round() as u16);
        // Codes below black share its light: black is what they become.
        let codes = black as usize..=white as usize;
        let nearest = |light: i32| {
            let light = f64::from(light);
            let mut codes = codes.clone();
            let above = codes.find(|code| exact[*code] >= light);
            let above = above.unwrap_or(white as usize);
            let below = above.saturating_sub(1).max(black as usize);
            let is_above = exact[above] - light <= light - exact[below];
            (if is_above { above } else { below }) as u8
        };
        Self {
            light,
            code: (0..=WHITE).map(nearest).collect(),
        }
    }

    /// Some rows of the half of a plane of luma.
    pub(crate) fn half_rows(&self, fine: &[u8], size: [u32; 2], range: Range<usize>) -> Vec<u8> {
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
        let light: Vec<u16> = codes.iter().map(|c| self.light[usize::from(*c)]).collect();
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
                *out = self.code[blend(near) as usize];
            }
        }
        coarse
    }
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
fn blend_rows(rows: [&[u16]; 6], out: &mut [i32]) {
    let n = out.len();
    let rows = rows.map(|row| &row[..n]);
    for x in 0..n {
        out[x] = blend(rows.map(|row| i32::from(row[x])));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::asset::picture::Matrix;
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

    fn half(table: &LightTable, fine: &[u8], size: [u32; 2]) -> Vec<u8> {
        table.half_rows(fine, size, 0..size[1].div_ceil(2) as usize)
    }

    /// The definition, one texel at a time.
    fn slow_half(table: &LightTable, fine: &[u8], [w, h]: [u32; 2]) -> Vec<u8> {
        let light = |x: i64, y: i64| {
            let (x, y) = (x.clamp(0, i64::from(w) - 1), y.clamp(0, i64::from(h) - 1));
            i32::from(table.light[usize::from(fine[(y * i64::from(w) + x) as usize])])
        };
        let six = |at: &dyn Fn(i64) -> i32| blend([-2, -1, 0, 1, 2, 3].map(at));
        let mut coarse = Vec::new();
        for y in 0..i64::from(h.div_ceil(2)) {
            for x in 0..i64::from(w.div_ceil(2)) {
                let column = |along: i64| {
                    let along = (2 * x + along).min(i64::from(w) - 1);
                    six(&|down| light(along, 2 * y + down))
                };
                coarse.push(table.code[six(&column) as usize]);
            }
        }
        coarse
    }

    proptest! {
        #[test]
        fn the_fast_half_is_the_slow_one(w in 1u32..70, h in 1u32..40, seed in 0u32..1000) {
            let fine = noise((w * h) as usize, seed);
            for colour in [FULL, LIMITED] {
                let table = LightTable::of(colour);
                prop_assert_eq!(half(table, &fine, [w, h]), slow_half(table, &fine, [w, h]));
            }
        }

        #[test]
        fn nothing_rings(w in 1u32..40, h in 1u32..40, seed in 0u32..1000) {
            let fine: Vec<u8> = noise((w * h) as usize, seed).iter().map(|s| 90 + s % 80).collect();
            let (least, most) = (fine.iter().min().unwrap(), fine.iter().max().unwrap());
            let coarse = half(&LIMITED_RANGE, &fine, [w, h]);
            prop_assert!(coarse.iter().all(|sample| (least..=most).contains(&sample)));
        }
    }

    #[test]
    fn every_code_that_is_shown_stays_itself() {
        for (colour, codes) in [(FULL, 0..=255), (LIMITED, 16..=235)] {
            for code in codes {
                let coarse = half(LightTable::of(colour), &[code; 12], [4, 3]);
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
            let table = LightTable::of(colour);
            let light = |code: u8| f64::from(table.light[usize::from(code)]);
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
