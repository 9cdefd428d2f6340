//! How much contrast has a picture in each octave of frequencies, at each place?
//!
//! Peli 1990: band-passed luminance over the local mean below the band. The bands are differences
//! of an octave pyramid: halved by (1, 3, 3, 1)/8 on both axes, doubled by bilinear interpolation,
//! both with samples at the centres of their cells and with borders repeated.

use crate::units::{Cpd, Ppd};
use core::f64::consts::PI;

/// Most bands of a pyramid.
pub const MAX_BANDS: usize = 8;
/// Shortest side that still has a band.
const MIN_SIDE: u32 = 4;

/// What pictures are computed in: double precision, or single where many are measured.
pub trait Sample:
    Copy
    + From<f32>
    + Into<f64>
    + core::ops::Add<Output = Self>
    + core::ops::Sub<Output = Self>
    + core::ops::Mul<Output = Self>
    + core::ops::Div<Output = Self>
{
    /// Its distance from 0.
    #[must_use]
    fn size(self) -> Self;
}

impl Sample for f32 {
    fn size(self) -> Self {
        self.abs()
    }
}

impl Sample for f64 {
    fn size(self) -> Self {
        self.abs()
    }
}

/// One picture's contrasts.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid {
    /// Octave bands, the finest first.
    pub bands: Vec<Band>,
}

/// Contrast in one octave.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Signed contrast of every texel, row by row: a grating of contrast m at the band's frequency
    /// has crests of m.
    pub contrast: Vec<f64>,
}

impl Pyramid {
    /// Contrasts of a picture of `size` whose pixels have `luminance` in cd/m², above 0.
    ///
    /// # Panics
    /// When there are not as many values as pixels.
    #[must_use]
    pub fn of(luminance: Vec<f64>, size: [u32; 2]) -> Self {
        assert!(luminance.len() == pixels(size), "one value for every pixel");
        let mut bands = Vec::new();
        let (mut fine, mut fine_size) = (luminance, size);
        for index in 0..bands_of(size) {
            let (coarse, coarse_size) = halved(&fine, fine_size);
            let mean = doubled(&coarse, coarse_size, fine_size);
            let gain = band_gain(index);
            let contrast = fine
                .iter()
                .zip(&mean)
                .map(|(l, m)| (l - m) / m / gain)
                .collect();
            bands.push(Band {
                size: fine_size,
                contrast,
            });
            (fine, fine_size) = (coarse, coarse_size);
        }
        Self { bands }
    }
}

/// How many bands a picture of `size` has: as long as a side has four texels, at most
/// [`MAX_BANDS`].
#[must_use]
pub fn bands_of(size: [u32; 2]) -> usize {
    let mut side = size[0].min(size[1]);
    let mut bands = 0;
    while side >= MIN_SIDE && bands < MAX_BANDS {
        bands += 1;
        side = side.div_ceil(2);
    }
    bands
}

/// Centre of a band at the eye, where the picture has `ppd` pixels per degree: half of the highest
/// frequency of its texels, a period of four of them.
#[must_use]
pub fn band_frequency(index: usize, Ppd(ppd): Ppd) -> Cpd {
    Cpd(libm::ldexp(ppd, -2 - index as i32))
}

/// What the filters leave of a grating along an axis at the centre of a band.
#[must_use]
pub fn band_gain(index: usize) -> f64 {
    // Halving keeps cos³ of half the phase per texel; the band is what is lost by halving and
    // doubling, both cos³.
    let kept = |half_phase: f64| {
        let cos = libm::cos(half_phase);
        cos * cos * cos
    };
    let half_phase = PI / 4.0;
    let below: f64 = (1..=index as i32)
        .map(|octaves| kept(libm::ldexp(half_phase, -octaves)))
        .product();
    below * (1.0 - kept(half_phase) * kept(half_phase))
}

/// Columns and rows of the next coarser level.
#[must_use]
pub fn half_size(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(2))
}

fn pixels([w, h]: [u32; 2]) -> usize {
    w as usize * h as usize
}

/// The next coarser level and its size.
///
/// Along each row first, then down the columns: each row is filtered once.
#[must_use]
pub fn halved<S: Sample>(fine: &[S], size: [u32; 2]) -> (Vec<S>, [u32; 2]) {
    let [w, h] = size.map(|side| side as usize);
    let coarse_size = half_size(size);
    let [cw, ch] = coarse_size.map(|side| side as usize);
    let mut along = Vec::with_capacity(cw * h);
    for row in fine.chunks_exact(w).take(h) {
        halve_row(row, &mut along);
    }
    let mut coarse = Vec::with_capacity(cw * ch);
    for y in 0..ch {
        let [a, b, c, d] = four_around(y, h).map(|row| along[row * cw..][..cw].iter());
        let rows = a.zip(b).zip(c.zip(d));
        coarse.extend(rows.map(|((a, b), (c, d))| tap([*a, *b, *c, *d])));
    }
    (coarse, coarse_size)
}

#[inline(always)]
fn tap<S: Sample>([a, b, c, d]: [S; 4]) -> S {
    (a + S::from(3.0) * (b + c) + d) / S::from(8.0)
}

/// A quarter of the way from one sample to the next.
#[inline(always)]
fn between<S: Sample>(near: S, far: S) -> S {
    S::from(0.75) * near + S::from(0.25) * far
}

/// Appends every second place of a row, filtered.
#[inline(always)]
fn halve_row<S: Sample>(row: &[S], out: &mut Vec<S>) {
    let (w, half) = (row.len(), row.len().div_ceil(2));
    let clamped = |x: usize| tap(four_around(x, w).map(|column| row[column]));
    out.push(clamped(0));
    // Away from the borders four samples lie side by side, two further on each time.
    let pairs = |from: usize| row.get(from..).unwrap_or_default().chunks_exact(2);
    let inside = pairs(1).zip(pairs(3));
    let done = 1 + inside.len();
    out.extend(inside.map(|(left, right)| tap([left[0], left[1], right[0], right[1]])));
    out.extend((done..half).map(clamped));
}

/// The four fine samples that one coarse sample covers, of `count`; the border repeats.
#[inline(always)]
pub(crate) fn four_around(coarse: usize, count: usize) -> [usize; 4] {
    let first = 2 * coarse;
    [first.saturating_sub(1), first, first + 1, first + 2].map(|fine| fine.min(count - 1))
}

/// A coarse level at a finer level's size: bilinear between centres of cells.
#[must_use]
pub fn doubled<S: Sample>(coarse: &[S], coarse_size: [u32; 2], fine_size: [u32; 2]) -> Vec<S> {
    let [cw, ch] = coarse_size.map(|side| side as usize);
    let [w, h] = fine_size.map(|side| side as usize);
    let mut along = Vec::with_capacity(w * ch);
    for row in coarse.chunks_exact(cw).take(ch) {
        double_row(row, w, &mut along);
    }
    let mut fine = Vec::with_capacity(w * h);
    for y in 0..h {
        let [near, far] = two_around(y, ch).map(|row| along[row * w..][..w].iter());
        fine.extend(near.zip(far).map(|(near, far)| between(*near, *far)));
    }
    fine
}

/// Appends a row at `width` places, bilinear.
#[inline(always)]
fn double_row<S: Sample>(row: &[S], width: usize, out: &mut Vec<S>) {
    let count = row.len();
    let place = |x: usize| {
        let [near, far] = two_around(x, count);
        between(row[near], row[far])
    };
    out.push(place(0));
    let done = 1 + 2 * (count - 1).min((width - 1) / 2);
    let before = out.len();
    out.resize(before + done - 1, S::from(0.0));
    for (pair, places) in row.windows(2).zip(out[before..].chunks_exact_mut(2)) {
        places[0] = between(pair[0], pair[1]);
        places[1] = between(pair[1], pair[0]);
    }
    out.extend((done..width).map(place));
}

/// The coarse sample that a fine one lies in, and the one that it lies next to, of `count`.
#[inline(always)]
fn two_around(fine: usize, count: usize) -> [usize; 2] {
    let near = fine / 2;
    let far = if fine.is_multiple_of(2) {
        near.saturating_sub(1)
    } else {
        near + 1
    };
    [near, far.min(count - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grating(size: [u32; 2], contrast: f64, period: f64, vertical: bool) -> Vec<f64> {
        let mut values = Vec::new();
        for y in 0..size[1] {
            for x in 0..size[0] {
                let along = if vertical { y } else { x };
                let phase = 2.0 * PI * (f64::from(along) + 0.5) / period;
                values.push(50.0 * (1.0 + contrast * libm::cos(phase)));
            }
        }
        values
    }

    /// Largest contrast of a band away from the border.
    fn crest(band: &Band) -> f64 {
        let [w, h] = band.size.map(|side| side as usize);
        let mut most: f64 = 0.0;
        for y in h / 4..h - h / 4 {
            for x in w / 4..w - w / 4 {
                most = most.max(band.contrast[y * w + x].abs());
            }
        }
        most
    }

    /// The definition, one sample at a time.
    fn slowly_halved(fine: &[f64], size: [u32; 2]) -> Vec<f64> {
        let [w, h] = size.map(|side| side as usize);
        let mut coarse = Vec::new();
        for y in 0..h.div_ceil(2) {
            for x in 0..w.div_ceil(2) {
                let rows = four_around(y, h).map(|row| &fine[row * w..][..w]);
                let columns = four_around(x, w);
                coarse.push(tap(rows.map(|row| tap(columns.map(|column| row[column])))));
            }
        }
        coarse
    }

    fn slowly_doubled(coarse: &[f64], size: [u32; 2], fine_size: [u32; 2]) -> Vec<f64> {
        let [cw, ch] = size.map(|side| side as usize);
        let [w, h] = fine_size.map(|side| side as usize);
        let mut fine = Vec::new();
        for y in 0..h {
            let rows = two_around(y, ch).map(|row| &coarse[row * cw..][..cw]);
            for x in 0..w {
                let [near, far] = two_around(x, cw);
                let [a, b] = rows.map(|row| 0.75 * row[near] + 0.25 * row[far]);
                fine.push(0.75 * a + 0.25 * b);
            }
        }
        fine
    }

    #[test]
    fn rows_at_once_are_samples_one_by_one() {
        for w in 1..20u32 {
            for h in [1u32, 2, 3, 8, 13] {
                let value = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 20) / 7.0;
                let fine: Vec<f64> = (0..w * h).map(value).collect();
                let (coarse, coarse_size) = halved(&fine, [w, h]);
                assert_eq!(coarse, slowly_halved(&fine, [w, h]), "{w}x{h}");
                let again = doubled(&coarse, coarse_size, [w, h]);
                assert_eq!(
                    again,
                    slowly_doubled(&coarse, coarse_size, [w, h]),
                    "{w}x{h}"
                );
            }
        }
    }

    #[test]
    fn a_plain_picture_has_no_contrast() {
        for size in [[64, 48], [37, 53], [8, 8], [5, 300]] {
            let pyramid = Pyramid::of(vec![20.0; pixels(size)], size);
            assert_eq!(pyramid.bands.len(), bands_of(size));
            let all = pyramid.bands.iter().flat_map(|band| &band.contrast);
            assert!(all.into_iter().all(|c| c.abs() < 1e-12));
        }
        assert_eq!(bands_of([1, 1]), 0);
        assert_eq!(bands_of([1920, 1080]), 8);
    }

    #[test]
    fn a_grating_has_its_contrast_in_the_band_of_its_frequency() {
        let size = [256, 256];
        for vertical in [false, true] {
            for index in 0..4 {
                // Four texels of the band; a little more in the picture, so that crests are met.
                let period = libm::ldexp(4.0, index as i32) * 1.01;
                let pyramid = Pyramid::of(grating(size, 0.1, period, vertical), size);
                let crests: Vec<f64> = pyramid.bands.iter().map(crest).collect();
                assert!((crests[index] - 0.1).abs() < 0.008, "{index}: {crests:?}");
                for (other, found) in crests.iter().enumerate() {
                    assert!(
                        *found <= crests[index] + 1e-9,
                        "{index} {other}: {crests:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn contrast_does_not_depend_on_brightness() {
        let size = [64, 64];
        let dim = Pyramid::of(grating(size, 0.4, 9.0, false), size);
        let bright = grating(size, 0.4, 9.0, false)
            .iter()
            .map(|l| 7.0 * l)
            .collect();
        let bright = Pyramid::of(bright, size);
        for (a, b) in dim.bands.iter().zip(&bright.bands) {
            assert!(
                a.contrast
                    .iter()
                    .zip(&b.contrast)
                    .all(|(a, b)| (a - b).abs() < 1e-12)
            );
        }
    }

    #[test]
    fn halving_a_ramp_keeps_it_away_from_the_border() {
        let size = [33, 20];
        let ramp: Vec<f64> = (0..20 * 33).map(|i| f64::from(i % 33)).collect();
        let (coarse, coarse_size) = halved(&ramp, size);
        assert_eq!(coarse_size, [17, 10]);
        for x in 1..15 {
            assert!((coarse[5 * 17 + x] - (2.0 * x as f64 + 0.5)).abs() < 1e-12);
        }
        let fine = doubled(&coarse, coarse_size, size);
        for x in 4..28 {
            assert!((fine[7 * 33 + x] - x as f64).abs() < 1e-12);
        }
    }
}
