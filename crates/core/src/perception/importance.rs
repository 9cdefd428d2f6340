//! What is a step to a finer level worth at every pixel, and to every unit?
//!
//! The clear version, in double precision: what the fast path and the GPU are held against.

use super::eye::{Gaze, Seen};
use super::gain::{BandStep, Weights, band_gain};
use super::measures::pyramid::{Band, Pyramid, band_frequency, doubled};
use super::parameters::{EyeState, Parameters};
use crate::units::{Cpd, Ppd, Radians};
use crate::view::eye_view::EyeView;
use glam::DVec3;

/// The id of pixels that belong to no unit.
pub const NO_UNIT: u32 = u32::MAX;

/// Who looks at the picture, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onlooker {
    /// What shows the picture.
    pub view: EyeView,
    /// Where the eye looks.
    pub gaze: Gaze,
    /// What the eye does.
    pub state: EyeState,
}

/// A pixel as the eye sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelSpot {
    /// Unit direction in the space of the view.
    pub direction: DVec3,
    /// Pixels per degree: the geometric mean of both axes.
    pub ppd: Ppd,
}

impl Onlooker {
    /// A steady eye that looks, for certain, where the view points.
    #[must_use]
    pub fn at_rest(view: &EyeView) -> Self {
        Self {
            view: *view,
            gaze: Gaze {
                direction: view.axes.forward,
                spread: Radians(0.0),
            },
            state: EyeState::Steady,
        }
    }

    /// Where a place of the picture (pixel centres at +0.5) lies, and how dense pixels are there.
    #[must_use]
    pub fn spot(&self, place: [f64; 2]) -> PixelSpot {
        let ray = self.view.ray(place);
        let (field, [w, h]) = (self.view.field, self.view.size.map(f64::from));
        let pixel = (field.left + field.right) / w * ((field.up + field.down) / h);
        // The solid angle of a pixel at unit depth shrinks with the cube of its distance.
        let distance = ray.length();
        let steradians = pixel / (distance * distance * distance);
        PixelSpot {
            direction: ray / distance,
            ppd: Ppd(core::f64::consts::PI / 180.0 / steradians.sqrt()),
        }
    }

    /// What this eye sees of the band `index` at a place.
    #[must_use]
    pub fn seen(&self, parameters: &Parameters, index: usize, place: [f64; 2]) -> Seen {
        let spot = self.spot(place);
        let frequency = band_frequency(index, spot.ppd);
        match self.state {
            EyeState::Jumping => parameters.seen_from_anywhere(frequency, parameters.luminance),
            _ => {
                let there = self.gaze.place(spot.direction, &parameters.acuity_model());
                let luminance = parameters.luminance;
                parameters.seen(frequency, there.eccentricity, there.acuity, luminance)
            }
        }
    }

    /// The band's centre frequency at a place.
    fn frequency(&self, index: usize, place: [f64; 2]) -> Cpd {
        band_frequency(index, self.spot(place).ppd)
    }

    /// Value of every pixel, row by row, of a step between two pictures of the view's size.
    ///
    /// # Panics
    /// When the pyramids are not of the view's size.
    #[must_use]
    pub fn step_map(
        &self,
        parameters: &Parameters,
        weights: &Weights,
        before: &Pyramid,
        after: &Pyramid,
    ) -> Vec<f64> {
        let bands = before.bands.iter().zip(&after.bands).enumerate().rev();
        let mut sum: Option<(Vec<f64>, [u32; 2])> = None;
        for (index, (before, after)) in bands {
            assert!(before.size == after.size, "pictures of one size");
            let mut gains = self.band_map(parameters, weights, index, [before, after]);
            if let Some((coarser, size)) = sum {
                let coarser = doubled(&coarser, size, before.size);
                gains
                    .iter_mut()
                    .zip(coarser)
                    .for_each(|(gain, below)| *gain += below);
            }
            sum = Some((gains, before.size));
        }
        let [w, h] = self.view.size.map(|side| side as usize);
        let mut values = sum.map_or_else(|| vec![0.0; w * h], |(gains, _)| gains);
        assert!(values.len() == w * h, "pictures of the view's size");
        for (pixel, value) in values.iter_mut().enumerate() {
            let place = [(pixel % w) as f64 + 0.5, (pixel / w) as f64 + 0.5];
            *value = self.whole_value(parameters, weights, place, *value);
        }
        values
    }

    fn band_map(
        &self,
        parameters: &Parameters,
        weights: &Weights,
        index: usize,
        [before, after]: [&Band; 2],
    ) -> Vec<f64> {
        let width = before.size[0] as usize;
        let contrasts = before.contrast.iter().zip(&after.contrast).enumerate();
        contrasts
            .map(|(texel, (&c, &c_after))| {
                let place = self.texel_place(index, [texel % width, texel / width]);
                let band = BandStep {
                    cpd: self.frequency(index, place),
                    contrast_before: c.abs(),
                    contrast_after: c_after.abs(),
                    difference: (c - c_after).abs(),
                };
                let seen = self.seen(parameters, index, place);
                band_gain(weights, seen, parameters.omega, &band)
            })
            .collect()
    }

    /// The centre of a band's texel in the picture; the last one may reach over the border.
    #[must_use]
    pub fn texel_place(&self, index: usize, texel: [usize; 2]) -> [f64; 2] {
        let side = libm::ldexp(1.0, index as i32);
        let [w, h] = self.view.size.map(f64::from);
        let [x, y] = texel.map(|t| (t as f64 + 0.5) * side);
        [x.min(w), y.min(h)]
    }

    /// The value of a pixel from what its bands add up to.
    fn whole_value(
        &self,
        parameters: &Parameters,
        weights: &Weights,
        place: [f64; 2],
        bands: f64,
    ) -> f64 {
        let spot = self.spot(place);
        let acuity = if weights.acuity == 0.0 {
            0.0
        } else {
            let model = parameters.acuity_model();
            weights.acuity * self.gaze.place(spot.direction, &model).acuity.0
        };
        let area = if weights.by_area {
            1.0 / (spot.ppd.0 * spot.ppd.0)
        } else {
            1.0
        };
        (bands + acuity + weights.constant) * area
    }

    /// Value of every unit and step: `[step][unit]`, step i from level i + 1 to level i, for level
    /// pictures with the finest first.
    ///
    /// # Panics
    /// When sizes differ, or an id is neither below `units` nor [`NO_UNIT`].
    #[must_use]
    pub fn unit_gains(
        &self,
        parameters: &Parameters,
        levels: &[Pyramid],
        unit_ids: &[u32],
        units: usize,
    ) -> Vec<Vec<f64>> {
        let weights = parameters.weights(self.state);
        levels
            .windows(2)
            .map(|pair| {
                let map = self.step_map(parameters, &weights, &pair[1], &pair[0]);
                sums_per_unit(&map, unit_ids, units)
            })
            .collect()
    }
}

/// Adds up the values of the pixels of every unit. Chen et al. 2022, Eq. 5.
///
/// # Panics
/// When there are not as many ids as pixels, or an id is neither below `units` nor [`NO_UNIT`].
#[must_use]
pub fn sums_per_unit(values: &[f64], unit_ids: &[u32], units: usize) -> Vec<f64> {
    assert!(
        values.len() == unit_ids.len(),
        "one unit id for every pixel"
    );
    let mut sums = vec![0.0; units];
    for (value, &id) in values.iter().zip(unit_ids) {
        if id != NO_UNIT {
            sums[id as usize] += value;
        }
    }
    sums
}

#[cfg(test)]
mod tests;
