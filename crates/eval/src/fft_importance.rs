//! What are steps worth, with contrast from Fourier transforms?
//!
//! The way of Chen et al. 2022 (their published code): every band is a Gaussian ring in the
//! spectrum, brought back by an inverse transform, over a low-pass of the same width. It is what
//! the pyramid of `foveal_core::perception` is compared with, in what it says and in what it
//! costs.

use foveal_core::perception::eye::Seen;
use foveal_core::perception::gain::Weights;
use foveal_core::perception::importance::{NO_UNIT, Onlooker};
use foveal_core::perception::measures::pyramid::bands_of;
use foveal_core::perception::parameters::Parameters;
use foveal_core::view::eye_view::EyeView;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// Standard deviation of a ring and of its low-pass, relative to the ring's frequency.
const RELATIVE_WIDTH: f64 = 0.3;
/// Least local mean that contrast is taken over, as in the published code.
const LEAST_MEAN: f32 = 0.1;
/// Pixels of a square that shares one sensitivity.
const BLOCK: usize = 8;

/// Sensitivity at the frequencies of the published code: the square of Barten's size term is
/// missing, and its width is 10 degrees; 100 cd/m².
#[must_use]
pub fn peer_sensitivity(cpd: f64) -> f64 {
    let a = 540.0 * (1.0_f64 + 0.7 / 100.0).powf(-0.2) / (1.0 + 12.0 / (10.0 * (1.0 + cpd / 3.0)));
    let b = 0.3 * 2.0_f64.powf(0.15);
    a * cpd * (-b * cpd).exp() * (1.0 + 0.06 * (b * cpd).exp()).sqrt()
}

/// What a ring round `centre` leaves of a frequency (both in the same unit).
#[must_use]
pub fn ring(frequency: f64, centre: f64) -> f64 {
    let off = (frequency - centre) / (RELATIVE_WIDTH * centre);
    (-0.5 * off * off).exp()
}

/// What the low-pass below a ring leaves of a frequency.
#[must_use]
pub fn low_pass(frequency: f64, centre: f64) -> f64 {
    let off = frequency / (RELATIVE_WIDTH * centre);
    (-0.5 * off * off).exp()
}

/// Transforms of one picture size.
pub struct Transforms {
    size: [usize; 2],
    /// Forward and back, along rows and along columns.
    along: [[Arc<dyn Fft<f32>>; 2]; 2],
    rows: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
}

impl Transforms {
    /// For pictures of `size`.
    #[must_use]
    pub fn new(size: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let along = size.map(|side| {
            [
                planner.plan_fft_forward(side),
                planner.plan_fft_inverse(side),
            ]
        });
        let scratch = along
            .iter()
            .flatten()
            .map(|fft| fft.get_inplace_scratch_len())
            .fold(0, usize::max);
        Self {
            size,
            along,
            rows: vec![Complex::default(); size[0] * size[1]],
            scratch: vec![Complex::default(); scratch],
        }
    }

    /// Spectrum of a real picture, column by column.
    pub fn forward(&mut self, picture: &[f32], spectrum: &mut [Complex<f32>]) {
        for (value, &real) in self.rows.iter_mut().zip(picture) {
            *value = Complex::new(real, 0.0);
        }
        self.along[0][0].process_with_scratch(&mut self.rows, &mut self.scratch);
        transpose(&self.rows, self.size, spectrum);
        self.along[1][0].process_with_scratch(spectrum, &mut self.scratch);
    }

    /// Contrast in the ring round `centre` cycles per pixel of a picture with this spectrum.
    /// Band and local mean, both real, come back in one transform.
    pub fn contrast(
        &mut self,
        spectrum: &[Complex<f32>],
        centre: f64,
        work: &mut [Complex<f32>],
        out: &mut [f32],
    ) {
        let [w, h] = self.size;
        let columns = work
            .chunks_exact_mut(h)
            .zip(spectrum.chunks_exact(h))
            .enumerate();
        for (x, (work, spectrum)) in columns {
            let across = frequency(x, w);
            for (y, (work, value)) in work.iter_mut().zip(spectrum).enumerate() {
                let down = frequency(y, h);
                let f = (across * across + down * down).sqrt();
                let filter = Complex::new(ring(f, centre) as f32, low_pass(f, centre) as f32);
                *work = value * filter;
            }
        }
        self.invert(work, out);
    }

    fn invert(&mut self, work: &mut [Complex<f32>], out: &mut [f32]) {
        let [w, h] = self.size;
        self.along[1][1].process_with_scratch(work, &mut self.scratch);
        transpose(work, [h, w], &mut self.rows);
        self.along[0][1].process_with_scratch(&mut self.rows, &mut self.scratch);
        let scale = 1.0 / (w * h) as f32;
        for (contrast, value) in out.iter_mut().zip(&self.rows) {
            *contrast = value.re * scale / (value.im * scale).max(LEAST_MEAN);
        }
    }
}

/// Cycles per pixel of a bin of a transform of `count` samples.
fn frequency(bin: usize, count: usize) -> f64 {
    bin.min(count - bin) as f64 / count as f64
}

fn transpose(from: &[Complex<f32>], [w, h]: [usize; 2], to: &mut [Complex<f32>]) {
    const SIDE: usize = 16;
    for y0 in (0..h).step_by(SIDE) {
        for x0 in (0..w).step_by(SIDE) {
            for y in y0..(y0 + SIDE).min(h) {
                for x in x0..(x0 + SIDE).min(w) {
                    to[x * h + y] = from[y * w + x];
                }
            }
        }
    }
}

/// Importance of level pictures through Fourier transforms, with the terms and weights of
/// `foveal_core::perception::gain`.
pub struct FftImportance {
    parameters: Parameters,
    size: [usize; 2],
    weights: Weights,
    transforms: Transforms,
    luma: [f32; 256],
    spectra: Vec<Vec<Complex<f32>>>,
    work: Vec<Complex<f32>>,
    filters: usize,
    contrast: Vec<Vec<f32>>,
    sums: Vec<Vec<f32>>,
    /// `[band][block]`.
    seen: Vec<Vec<Seen>>,
    /// Value of a pixel besides its bands and the factor on all of it, by block.
    whole: Vec<[f64; 2]>,
}

impl FftImportance {
    /// For `levels` pictures of the view's size.
    #[must_use]
    pub fn new(parameters: &Parameters, view: &EyeView, levels: usize) -> Self {
        let size = view.size.map(|side| side as usize);
        let pixels = size[0] * size[1];
        Self {
            parameters: parameters.clone(),
            size,
            weights: Weights::default(),
            transforms: Transforms::new(size),
            luma: parameters.luma_table().map(|l| l as f32),
            spectra: vec![vec![Complex::default(); pixels]; levels],
            work: vec![Complex::default(); pixels],
            filters: bands_of(view.size),
            contrast: vec![vec![0.0; pixels]; levels],
            sums: vec![vec![0.0; pixels]; levels.saturating_sub(1)],
            seen: Vec::new(),
            whole: Vec::new(),
        }
    }

    fn blocks(&self) -> [usize; 2] {
        self.size.map(|side| side.div_ceil(BLOCK))
    }

    /// Looks somewhere, and weighs as given. Sensitivities come from the exact formula: slow.
    pub fn look(&mut self, onlooker: &Onlooker, weights: &Weights) {
        let [columns, rows] = self.blocks();
        let place = |block: usize| {
            [block % columns, block / columns].map(|at| (at as f64 + 0.5) * BLOCK as f64)
        };
        let blocks = 0..columns * rows;
        let seen = |band: usize, block| onlooker.seen(&self.parameters, band, place(block));
        self.seen = (0..self.filters)
            .map(|band| blocks.clone().map(|block| seen(band, block)).collect())
            .collect();
        let whole = |block| {
            let spot = onlooker.spot(place(block));
            let there = onlooker
                .gaze
                .place(spot.direction, &self.parameters.acuity_model());
            let area = if weights.by_area {
                spot.ppd.0.powi(-2)
            } else {
                1.0
            };
            [weights.acuity * there.acuity.0 + weights.constant, area]
        };
        self.whole = blocks.clone().map(whole).collect();
        self.weights = *weights;
    }

    /// Value of every step and unit, laid out as by `FastImportance::unit_gains`.
    ///
    /// # Panics
    /// When pictures, ids or gains are not as set up.
    pub fn unit_gains(&mut self, levels: &[&[u8]], unit_ids: &[u32], gains: &mut [f64]) {
        let mut picture = vec![0.0; unit_ids.len()];
        for (luma, spectrum) in levels.iter().zip(&mut self.spectra) {
            for (value, &code) in picture.iter_mut().zip(*luma) {
                *value = self.luma[usize::from(code)];
            }
            self.transforms.forward(&picture, spectrum);
        }
        self.sums.iter_mut().for_each(|sum| sum.fill(0.0));
        for band in 0..self.filters {
            let centre = 0.25 / f64::from(1_u32 << band);
            for (spectrum, contrast) in self.spectra.iter().zip(&mut self.contrast) {
                self.transforms
                    .contrast(spectrum, centre, &mut self.work, contrast);
            }
            for step in 0..self.sums.len() {
                self.add_band(band, step);
            }
        }
        let units = gains.len() / self.sums.len();
        let columns = self.blocks()[0];
        gains.fill(0.0);
        for (sum, gains) in self.sums.iter().zip(gains.chunks_mut(units)) {
            for (pixel, (value, &id)) in sum.iter().zip(unit_ids).enumerate() {
                let [offset, factor] = self.whole[block_of(pixel, self.size[0], columns)];
                if id != NO_UNIT {
                    gains[id as usize] += (f64::from(*value) + offset) * factor;
                }
            }
        }
    }

    fn add_band(&mut self, band: usize, step: usize) {
        let (weights, omega) = (self.weights, self.parameters.omega as f32);
        let (error, popping) = (weights.error as f32, weights.popping as f32);
        let columns = self.blocks()[0];
        let seen = &self.seen[band];
        let pair = self.contrast[step + 1].iter().zip(&self.contrast[step]);
        for (pixel, (sum, (before, after))) in self.sums[step].iter_mut().zip(pair).enumerate() {
            let Seen {
                sustained,
                transient,
            } = seen[block_of(pixel, self.size[0], columns)];
            let (sustained, transient) = (sustained as f32, transient as f32);
            let change = (before - after).abs();
            let ground = transient * before.abs() + omega;
            *sum += change * (error * sustained + popping * transient / ground);
        }
    }
}

fn block_of(pixel: usize, width: usize, columns: usize) -> usize {
    pixel / width / BLOCK * columns + pixel % width / BLOCK
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::importance_bench::Decision;
    use foveal_core::perception::csf::{SizeTerm, barten};
    use foveal_core::perception::fast::FastImportance;
    use foveal_core::units::Cpd;
    use std::f64::consts::PI;

    /// Contrast at a crest of a grating of `f0` cycles per image in the ring round `centre`.
    fn crest(contrast: f64, f0: f64, centre: f64) -> f64 {
        let side = 512;
        let value = |i: usize| {
            let phase = 2.0 * PI * f0 * (i % side) as f64 / side as f64;
            (128.0 * (1.0 + contrast * phase.cos())) as f32
        };
        let picture: Vec<f32> = (0..side * side).map(value).collect();
        let mut transforms = Transforms::new([side, side]);
        let mut spectrum = vec![Complex::default(); side * side];
        let mut work = spectrum.clone();
        let mut out = vec![0.0; side * side];
        transforms.forward(&picture, &mut spectrum);
        transforms.contrast(&spectrum, centre / side as f64, &mut work, &mut out);
        f64::from(out[0])
    }

    #[test]
    fn rings_leave_what_they_should() {
        assert!((ring(0.0, 64.0) - 0.0038659201394728).abs() < 1e-13);
        assert!((low_pass(64.0, 64.0) - 0.0038659201394728).abs() < 1e-13);
        assert!((ring(32.0, 64.0) - 0.2493522088).abs() < 1e-9);
        let sum = |f| (0..9).map(|i| ring(f, f64::from(1 << i))).sum::<f64>();
        assert!((sum(64.0) - 1.29716).abs() < 1e-5);
        assert!((sum(16.0 * std::f64::consts::SQRT_2) - 1.13757).abs() < 1e-5);
    }

    #[test]
    fn gratings_have_the_golden_contrasts_in_a_ring() {
        for (m, f0, centre, expected) in [
            (0.2, 64.0, 64.0, 0.203708416),
            (0.5, 64.0, 64.0, 0.5028938464),
            (0.2, 32.0, 64.0, 0.051183803),
            (0.2, 128.0, 64.0, 0.0046391042),
        ] {
            let found = crest(m, f0, centre);
            assert!((found - expected).abs() < 2e-6, "{m} {f0}: {found}");
        }
    }

    #[test]
    fn a_grating_that_grows_pops_as_much_as_in_the_published_code() {
        let (before, after) = (crest(0.2, 64.0, 64.0), crest(0.5, 64.0, 64.0));
        let s = peer_sensitivity(64.0 / 110.0);
        let inside = s * (after - before) / (s * before + 10.0);
        assert!((inside - 1.0739095387).abs() < 1e-5, "{inside}");
        let s = barten(Cpd(64.0 / 110.0), 100.0, SizeTerm::Printed);
        let outside = s * (after - before) / (before + 10.0);
        assert!((outside - 4.2723719282).abs() < 1e-4, "{outside}");
    }

    #[test]
    fn sensitivity_is_that_of_the_published_code() {
        let expected = [
            2.291209, 4.576474, 9.129025, 18.161259, 35.927055, 70.214790, 133.535919, 238.332794,
            366.908691,
        ];
        for (i, expected) in expected.into_iter().enumerate() {
            let found = peer_sensitivity(f64::from(1 << i) / 110.0);
            // Theirs is printed from single precision.
            assert!((found / expected - 1.0).abs() < 2e-6, "{i}: {found}");
        }
        for (f, expected) in [(0.5, 116.453619), (4.0, 416.717477), (60.0, 0.345114)] {
            assert!((peer_sensitivity(f) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn the_pyramid_ranks_units_as_the_rings_do() {
        let decision = Decision::generated([512, 320]);
        let parameters = Parameters::default();
        let onlooker = decision.onlooker;
        let weights = parameters.weights(onlooker.state);
        let levels = decision.luma.len();
        let mut rings = vec![0.0; decision.units * (levels - 1)];
        let mut pyramid = rings.clone();
        let mut fft = FftImportance::new(&parameters, &onlooker.view, levels);
        fft.look(&onlooker, &weights);
        fft.unit_gains(&decision.pictures(), &decision.unit_ids, &mut rings);
        let mut fast = FastImportance::new(&parameters, &onlooker.view, levels);
        fast.look(&onlooker, &weights);
        fast.unit_gains(&decision.pictures(), &decision.unit_ids, &mut pyramid);
        for (a, b) in rings
            .chunks(decision.units)
            .zip(pyramid.chunks(decision.units))
        {
            let r = correlation(a, b);
            assert!(r > 0.9, "{r}");
        }
    }

    fn correlation(a: &[f64], b: &[f64]) -> f64 {
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let (mean_a, mean_b) = (mean(a), mean(b));
        let product = |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 {
            x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum()
        };
        let spread = product(a, mean_a, a, mean_a) * product(b, mean_b, b, mean_b);
        product(a, mean_a, b, mean_b) / spread.sqrt()
    }
}
