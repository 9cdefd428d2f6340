//! Which pixels round the gaze are worth showing, and which of them stands for every other?
//!
//! The acuity mask and the interpolation mask of Kastner 2016, section 4.1.1: a square of pixels
//! centred on the gaze, samples as dense as the eye's acuity, and for every pixel the nearest
//! sample. The published mask was drawn in Matlab without a formula; here every pixel is ranked by
//! its threshold in a blue-noise order over the density that acuity asks for, and the first are
//! kept.

use crate::perception::acuity::AcuityModel;
use crate::perception::samples::blue_noise::{SIDE, blue_noise_ranks};
use crate::perception::samples::nearest_sample::{NEIGHBOURS, nearest_samples, neighbours_of};
use crate::units::Radians;

/// Steps of a pixel in which a radius is distinguished.
const STEPS: f64 = 4.0;
/// Seed of the blue-noise order of masks.
const SEED: u64 = 2016;
/// Radii at which the spacing of samples is noted, from the centre to the corner.
pub const SPACINGS: usize = 64;

/// What a mask depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskShape {
    /// Pixels on a side.
    pub side: u32,
    /// Tangent of the angle that a pixel of the view fills at its centre.
    pub pitch: f64,
    /// The eye.
    pub eye: AcuityModel,
}

/// Samples in a square of pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleMask {
    /// Pixels on a side; the gaze is at the centre of pixel `side / 2`.
    pub side: u32,
    /// Column and row of every sample, row by row.
    pub places: Vec<[u16; 2]>,
    /// For every pixel, row by row, the sample nearest to it; the sample itself on a sample.
    pub nearest: Vec<u32>,
    /// For every sample up to eight that share a border with it in `nearest`, nearer ones first;
    /// itself where there are fewer.
    pub neighbours: Vec<[u32; NEIGHBOURS]>,
    /// Mean distance between samples in pixels at [`SPACINGS`] radii, evenly from the centre to
    /// the corner; at least 1.
    pub spacings: Vec<f32>,
}

impl MaskShape {
    /// Samples a pixel that the eye can resolve, by radius in steps of a quarter pixel: one a
    /// minimum angle of resolution on both axes, so more than 1 where pixels are coarser than that.
    fn density(&self) -> Vec<f64> {
        let corner = f64::from(self.side) * core::f64::consts::FRAC_1_SQRT_2 + 2.0;
        let at = |step: u32| {
            let radius = f64::from(step) / STEPS;
            let eccentricity = Radians(libm::atan(radius * self.pitch));
            let pixel_deg = Radians(libm::atan(self.pitch)).to_degrees();
            let across = pixel_deg * 2.0 * self.eye.best_acuity(eccentricity).0;
            across * across
        };
        (0..(corner * STEPS) as u32).map(at).collect()
    }

    /// The radius of a pixel's centre from the gaze, in pixels.
    fn radius(&self, [x, y]: [u32; 2]) -> f64 {
        let away = |k: u32| f64::from(k) - f64::from(self.side / 2);
        (away(x) * away(x) + away(y) * away(y)).sqrt()
    }

    fn pixels(&self) -> impl Iterator<Item = [u32; 2]> {
        let side = self.side;
        (0..side).flat_map(move |y| (0..side).map(move |x| [x, y]))
    }

    /// How many samples the eye asks for: the sum of the densities, none above one a pixel.
    #[must_use]
    pub fn wanted_samples(&self) -> u32 {
        let density = self.density();
        let at = |pixel| density[(self.radius(pixel) * STEPS) as usize].min(1.0);
        let sum: f64 = self.pixels().map(at).sum();
        (sum.round() as u32).max(1)
    }
}

impl SampleMask {
    /// The mask of `samples` samples, 1 to `side`², or of as many as the eye asks for. Masks of one
    /// shape are nested: fewer samples are some of more. Costs about a second for 1920².
    #[must_use]
    pub fn new(shape: &MaskShape, samples: Option<u32>) -> Self {
        let count = samples.unwrap_or_else(|| shape.wanted_samples());
        let count = (count as usize).clamp(1, (shape.side as usize).pow(2));
        let density = shape.density();
        let (places, stretch) = first_places(shape, &density, count);
        let nearest = nearest_samples(shape.side, &places);
        let neighbours = neighbours_of(shape.side, &places, &nearest);
        let step = density.len() / SPACINGS;
        let spacing = |k: usize| (1.0 / (density[k * step] * stretch).sqrt()).max(1.0) as f32;
        Self {
            side: shape.side,
            spacings: (0..SPACINGS).map(spacing).collect(),
            places,
            nearest,
            neighbours,
        }
    }
}

impl SampleMask {
    /// Mean distance between samples round a place of the mask, in pixels.
    #[must_use]
    pub fn spacing(&self, place: [u16; 2]) -> f64 {
        let middle = f64::from(self.side / 2);
        let [x, y] = place.map(|k| f64::from(k) - middle);
        let corner = f64::from(self.side) * core::f64::consts::FRAC_1_SQRT_2 + 2.0;
        let step = ((x * x + y * y).sqrt() / corner * SPACINGS as f64) as usize;
        f64::from(self.spacings[step.min(SPACINGS - 1)])
    }
}

/// The places of the first `count` pixels by threshold over density, row by row, and by how much
/// that count stretches the density.
fn first_places(shape: &MaskShape, density: &[f64], count: usize) -> (Vec<[u16; 2]>, f64) {
    let ranks = blue_noise_ranks(SEED);
    let levels = (SIDE * SIDE) as f64;
    // Positive floats sort as their bits do; the pixel's number below them decides ties.
    let key = |(number, [x, y]): (u64, [u32; 2])| {
        let rank = ranks[y as usize % SIDE * SIDE + x as usize % SIDE];
        let threshold = (f64::from(rank) + 0.5) / levels;
        let order = threshold / density[(shape.radius([x, y]) * STEPS) as usize];
        u64::from((order as f32).to_bits()) << 32 | number
    };
    let mut keys: Vec<u64> = (0..).zip(shape.pixels()).map(key).collect();
    let last = *keys.select_nth_unstable(count - 1).1;
    keys.truncate(count);
    let mut numbers: Vec<u32> = keys.into_iter().map(|key| key as u32).collect();
    numbers.sort_unstable();
    let place = |number: u32| [number % shape.side, number / shape.side].map(|k| k as u16);
    let stretch = f64::from(f32::from_bits((last >> 32) as u32));
    (numbers.into_iter().map(place).collect(), stretch)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(side: u32) -> MaskShape {
        MaskShape {
            side,
            pitch: 0.9 / f64::from(side),
            eye: AcuityModel::LINEAR,
        }
    }

    #[test]
    fn fewer_samples_are_some_of_more() {
        let shape = shape(301);
        let all = SampleMask::new(&shape, Some(20_000));
        let some = SampleMask::new(&shape, Some(3_000));
        assert_eq!((all.places.len(), some.places.len()), (20_000, 3_000));
        let all: std::collections::HashSet<[u16; 2]> = all.places.into_iter().collect();
        assert!(some.places.iter().all(|place| all.contains(place)));
    }

    #[test]
    fn samples_are_as_dense_as_acuity_in_every_ring() {
        let shape = MaskShape {
            pitch: 0.45 / 480.0,
            ..shape(960)
        };
        for samples in [None, Some(120_000)] {
            let mask = SampleMask::new(&shape, samples);
            let wanted = samples.unwrap_or_else(|| shape.wanted_samples());
            assert_eq!(mask.places.len(), wanted as usize);
            for ring in 1..9 {
                let (from, to) = (f64::from(ring) * 50.0, f64::from(ring + 1) * 50.0);
                let within = |radius: f64| (from..to).contains(&radius);
                let of = |[x, y]: [u16; 2]| shape.radius([u32::from(x), u32::from(y)]);
                let found = mask
                    .places
                    .iter()
                    .filter(|place| within(of(**place)))
                    .count();
                let corner = shape.density().len() as f64 / STEPS;
                let expected: f64 = shape
                    .pixels()
                    .map(|pixel| shape.radius(pixel))
                    .filter(|radius| within(*radius))
                    .map(|radius| {
                        let step = radius / corner * SPACINGS as f64;
                        f64::from(mask.spacings[step as usize]).powi(-2)
                    })
                    .sum();
                let share = found as f64 / expected;
                assert!((0.85..1.15).contains(&share), "{samples:?} {from}: {share}");
            }
        }
    }

    #[test]
    fn every_pixel_of_the_fovea_is_a_sample_of_the_published_count() {
        let shape = MaskShape {
            side: 480,
            pitch: 0.9 / 480.0,
            eye: AcuityModel::LINEAR,
        };
        // 18.7 % of the mask, as 690,926 are of 1920².
        let mask = SampleMask::new(&shape, Some(43_182));
        let fovea = libm::tan(Radians::from_degrees(2.5).0) / shape.pitch;
        for pixel in shape.pixels().filter(|pixel| shape.radius(*pixel) <= fovea) {
            let number = mask.nearest[(pixel[1] * 480 + pixel[0]) as usize];
            assert_eq!(mask.places[number as usize].map(u32::from), pixel);
        }
    }
}
