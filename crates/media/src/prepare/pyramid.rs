//! What does the next coarser level of a picture look like?
//!
//! Coarse texel `i` covers exactly the fine texels `ratio * i .. ratio * (i + 1)`, so a place keeps
//! its position at every level. A level is half of the one before, filtered by six taps an axis:
//! luma as light ([`pyramid_light`](crate::prepare::pyramid_light)), chroma as code values.

use crate::parallel::in_parallel;
use crate::prepare::pyramid_light;
use crate::prepare::pyramid_taps::{REACH, TAPS};
use foveal_core::perception::measures::luma_light::LumaLight;
use foveal_core::view::picture::{Colour, Picture};
use std::ops::Range;

/// Coarse rows in one part of the work.
const STRIP: usize = 32;

/// The level that is `ratio` times coarser on each side; sizes round up, borders repeat.
///
/// Each plane is filtered alone, luma of this `colour` as light. Ratios above 2 are reached by
/// halving again, each time rounded to 8 bits. Costs about 2.3 ns a luma pixel of one core.
///
/// ```
/// use foveal_core::view::picture::{Colour, Matrix, Picture};
/// let colour = Colour { matrix: Matrix::Bt709, full_range: false, chroma_left: false };
/// let grey = Picture::filled(5, 3, [80, 90, 100]);
/// let coarse = foveal_media::prepare::pyramid::halve(&grey, 2, colour);
/// assert_eq!(coarse, Picture::filled(3, 2, [80, 90, 100]));
/// ```
///
/// # Panics
/// When `ratio` is not a power of two, or the picture lacks samples.
#[must_use]
pub fn halve(picture: &Picture, ratio: u32, colour: Colour) -> Picture {
    assert!(ratio.is_power_of_two(), "a ratio of {ratio} between levels");
    assert!(picture.is_consistent(), "a picture lacks samples");
    let mut coarse = picture.clone();
    for _ in 0..ratio.trailing_zeros() {
        let planes = [0, 1, 2].map(|p| {
            let rows = coarse.plane_size(p)[1].div_ceil(2) as usize;
            half_rows(&coarse, p, 0..rows, colour)
        });
        coarse = Picture {
            width: coarse.width.div_ceil(2),
            height: coarse.height.div_ceil(2),
            planes,
        };
    }
    coarse
}

/// [`halve`] of each picture, the same for any number of threads `jobs`.
///
/// # Panics
/// As [`halve`].
#[must_use]
pub fn halve_all(pictures: &[Picture], ratio: u32, colour: Colour, jobs: usize) -> Vec<Picture> {
    if ratio != 2 {
        return in_parallel(jobs, pictures.len(), |k| halve(&pictures[k], ratio, colour));
    }
    let strips_of = |(k, picture): (usize, &Picture)| {
        let strips = (0..3).flat_map(|p| {
            let rows = picture.plane_size(p)[1].div_ceil(2) as usize;
            let strip = |start: usize| (k, p, start..(start + STRIP).min(rows));
            (0..rows).step_by(STRIP).map(strip).collect::<Vec<_>>()
        });
        strips.collect::<Vec<_>>()
    };
    let strips: Vec<_> = pictures.iter().enumerate().flat_map(strips_of).collect();
    let rows = in_parallel(jobs, strips.len(), |strip| {
        let (k, p, rows) = &strips[strip];
        half_rows(&pictures[*k], *p, rows.clone(), colour)
    });
    let half = |picture: &Picture| Picture {
        width: picture.width.div_ceil(2),
        height: picture.height.div_ceil(2),
        planes: Default::default(),
    };
    let mut coarse: Vec<Picture> = pictures.iter().map(half).collect();
    for ((k, p, _), rows) in strips.iter().zip(rows) {
        coarse[*k].planes[*p].extend(rows);
    }
    coarse
}

/// Some rows of the half of one plane: down the columns first, then along the row.
fn half_rows(picture: &Picture, plane: usize, rows: Range<usize>, colour: Colour) -> Vec<u8> {
    let (fine, size) = (&picture.planes[plane], picture.plane_size(plane));
    match plane {
        0 => pyramid_light::half_rows(LumaLight::of(colour), fine, size, rows),
        _ => half_code_rows(fine, size, rows),
    }
}

/// Some rows of the half of a plane of chroma.
fn half_code_rows(fine: &[u8], size: [u32; 2], range: Range<usize>) -> Vec<u8> {
    let [w, h] = size.map(|n| n as usize);
    let coarse_w = w.div_ceil(2);
    let mut coarse = vec![0; coarse_w * range.len()];
    if coarse.is_empty() {
        return coarse;
    }
    // Two texels before the row and up to three after it, always an even number in all.
    let mut column = vec![0i16; 2 * coarse_w + 2 * REACH];
    let mut even = vec![0i16; coarse_w + REACH];
    let mut odd = vec![0i16; coarse_w + REACH];
    for (y, out) in range.zip(coarse.chunks_exact_mut(coarse_w)) {
        let rows = [0, 1, 2, 3, 4, 5].map(|tap| {
            let row = (2 * y + tap).saturating_sub(REACH).min(h - 1);
            &fine[row * w..][..w]
        });
        sum_rows(rows, &mut column[REACH..REACH + w]);
        let (first, last) = (column[REACH], column[REACH + w - 1]);
        column[..REACH].fill(first);
        column[REACH + w..].fill(last);
        for ((pair, even), odd) in column
            .as_chunks::<2>()
            .0
            .iter()
            .zip(&mut even)
            .zip(&mut odd)
        {
            [*even, *odd] = *pair;
        }
        sum_columns(&even, &odd, out);
    }
    coarse
}

/// Weighted sum of six rows, 32 times a code value; |sum| stays below 34 * 255.
fn sum_rows(rows: [&[u8]; 6], out: &mut [i16]) {
    let n = out.len();
    let [r0, r1, r2, r3, r4, r5] = rows.map(|row| &row[..n]);
    let [outer, inner, middle] = [TAPS[0] as i16, TAPS[1] as i16, TAPS[2] as i16];
    for x in 0..n {
        let pair = |a: &[u8], b: &[u8]| i16::from(a[x]) + i16::from(b[x]);
        out[x] = outer * pair(r0, r5) + inner * pair(r1, r4) + middle * pair(r2, r3);
    }
}

/// Weighted sum of six neighbours at every second place, given apart as even and odd places.
fn sum_columns(even: &[i16], odd: &[i16], out: &mut [u8]) {
    let n = out.len();
    let (e0, e1, e2) = (&even[..n], &even[1..][..n], &even[2..][..n]);
    let (o0, o1, o2) = (&odd[..n], &odd[1..][..n], &odd[2..][..n]);
    for x in 0..n {
        let pair = |a: &[i16], b: &[i16]| i32::from(a[x]) + i32::from(b[x]);
        let sum = TAPS[0] * pair(e0, o2) + TAPS[1] * pair(o0, e2) + TAPS[2] * pair(e1, o1);
        out[x] = ((sum + 512) >> 10).clamp(0, 255) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::picture::Matrix;
    use proptest::prelude::*;

    const FULL: Colour = Colour {
        matrix: Matrix::Bt709,
        full_range: true,
        chroma_left: false,
    };

    /// The definition, one texel at a time.
    fn slow_half_plane(fine: &[u8], [w, h]: [u32; 2]) -> Vec<u8> {
        let at = |x: i64, y: i64| {
            let (x, y) = (x.clamp(0, i64::from(w) - 1), y.clamp(0, i64::from(h) - 1));
            i32::from(fine[(y * i64::from(w) + x) as usize])
        };
        let mut coarse = Vec::new();
        for y in 0..i64::from(h.div_ceil(2)) {
            for x in 0..i64::from(w.div_ceil(2)) {
                let mut sum = 0;
                for (j, down) in TAPS.iter().enumerate() {
                    for (i, along) in TAPS.iter().enumerate() {
                        sum += down * along * at(2 * x + i as i64 - 2, 2 * y + j as i64 - 2);
                    }
                }
                coarse.push((f64::from(sum) / 1024.0 + 0.5).floor().clamp(0.0, 255.0) as u8);
            }
        }
        coarse
    }

    fn noise(width: u32, height: u32, seed: u32) -> Picture {
        let mut picture = Picture::filled(width, height, [0; 3]);
        let mut state = seed.wrapping_mul(2_654_435_761) | 1;
        for sample in picture.planes.iter_mut().flatten() {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *sample = (state >> 24) as u8;
        }
        picture
    }

    fn mean(plane: &[u8]) -> f64 {
        plane.iter().map(|&s| f64::from(s)).sum::<f64>() / plane.len() as f64
    }

    proptest! {
        #[test]
        fn the_fast_half_is_the_slow_one(w in 1u32..70, h in 1u32..40, seed in 0u32..1000) {
            let picture = noise(w, h, seed);
            let coarse = halve(&picture, 2, FULL);
            prop_assert!(coarse.is_consistent());
            for p in 1..3 {
                let slow = slow_half_plane(&picture.planes[p], picture.plane_size(p));
                prop_assert_eq!(&coarse.planes[p], &slow);
            }
        }

        #[test]
        fn strips_and_threads_change_nothing(
            w in 1u32..70, h in 1u32..200, jobs in 1usize..4, ratio in 0u32..3
        ) {
            let pictures = [noise(w, h, 1), noise(h, w, 2)];
            let alone = pictures.each_ref().map(|picture| halve(picture, 1 << ratio, FULL));
            prop_assert_eq!(halve_all(&pictures, 1 << ratio, FULL, jobs), alone);
        }

        #[test]
        fn a_constant_stays_constant(w in 1u32..40, h in 1u32..40, y in 0u8..=255) {
            let yuv = [y, 255 - y, y / 2];
            let coarse = halve(&Picture::filled(w, h, yuv), 4, FULL);
            prop_assert_eq!(coarse, Picture::filled(w.div_ceil(4), h.div_ceil(4), yuv));
        }

        #[test]
        fn the_mean_is_preserved(seed in 0u32..1000) {
            let mut picture = noise(128, 96, seed);
            // Soft enough that no overshoot is clipped.
            picture.planes.iter_mut().flatten().for_each(|s| *s = 64 + *s / 2);
            let coarse = halve(&picture, 2, FULL);
            for p in 1..3 {
                prop_assert!((mean(&coarse.planes[p]) - mean(&picture.planes[p])).abs() < 0.3);
            }
        }
    }

    #[test]
    fn one_row_or_column_is_halved_like_any_other() {
        for [w, h] in [[1, 1], [1, 9], [9, 1], [2, 1], [1, 64]] {
            let coarse = halve(&noise(w, h, 7), 2, FULL);
            assert_eq!(coarse.width, w.div_ceil(2));
            assert_eq!(coarse.height, h.div_ceil(2));
            assert!(coarse.is_consistent());
        }
    }

    #[test]
    fn a_ramp_stays_a_ramp_at_the_same_place() {
        for ratio in [2u32, 4, 8] {
            let mut picture = Picture::filled(240, 16, [0, 128, 128]);
            for (place, sample) in picture.planes[0].iter_mut().enumerate() {
                *sample = (place % 240) as u8;
            }
            let coarse = halve(&picture, ratio, FULL);
            let row = &coarse.planes[0][..coarse.width as usize];
            // The middle of texels r*i .. r*(i+1) has the value r*i + (r-1)/2; each halving may
            // round up by half a code value.
            for (i, &sample) in row.iter().enumerate().skip(3).take(row.len() - 6) {
                let middle = f64::from(ratio) * i as f64 + f64::from(ratio - 1) / 2.0;
                assert!(
                    (f64::from(sample) - middle).abs() <= 1.0,
                    "{ratio} {i} {sample}"
                );
            }
        }
    }

    #[test]
    fn a_pattern_at_the_fine_nyquist_limit_vanishes() {
        let mut picture = Picture::filled(128, 128, [0; 3]);
        for (place, sample) in picture.planes[1].iter_mut().enumerate() {
            *sample = if place % 2 == 0 { 50 } else { 150 };
        }
        let coarse = halve(&picture, 2, FULL);
        for row in coarse.planes[1].chunks_exact(32) {
            assert!(row[1..31].iter().all(|&sample| sample == 100));
        }
    }

    /// `cargo test --release -p foveal-media halving_speed -- --ignored --nocapture`
    #[test]
    #[ignore = "a measurement"]
    fn halving_speed() {
        let picture = noise(4096, 2048, 1);
        let start = std::time::Instant::now();
        for _ in 0..20 {
            std::hint::black_box(halve(std::hint::black_box(&picture), 2, FULL));
        }
        let rate = 20.0 * 4096.0 * 2048.0 / start.elapsed().as_secs_f64() / 1e6;
        println!("halve: {rate:.0} MPix/s of luma, chroma included");
    }
}
