//! What is every step worth to every unit, many times a second?
//!
//! The importance of [`super::importance`] in single precision on one thread: sensitivities from
//! tables at nodes, every picture's pyramid built once, one division per pixel of a picture and one
//! per step, rows as plain slices. After set-up nothing is allocated.

mod field;
pub mod instructions;
mod passes;
mod rows;
mod units;

use super::gain::Weights;
use super::importance::Onlooker;
use super::measures::pyramid::{bands_of, half_size};
use super::parameters::Parameters;
use crate::view::eye_view::EyeView;
use field::{EyeField, SPACING};
use instructions::Instructions;
use rows::PAD;

/// Decoded rows of a picture that are kept: what a row of the level below is made of, and the rows
/// that wait for it.
const DECODED: usize = 6;

/// Buffers and tables for level pictures of one size.
///
/// ```
/// use foveal_core::perception::fast::FastImportance;
/// use foveal_core::perception::importance::Onlooker;
/// use foveal_core::perception::parameters::Parameters;
/// use foveal_core::units::Radians;
/// use foveal_core::view::axes::Axes;
/// use foveal_core::view::eye_view::{EyeView, Field};
///
/// let size = [64, 32];
/// let field = Field::across(Radians(0.8), size);
/// let (position, eye) = Default::default();
/// let view = EyeView { position, axes: Axes::FRONT, field, size, eye };
/// let parameters = Parameters::default();
/// let mut importance = FastImportance::new(&parameters, &view, 2);
/// let onlooker = Onlooker::at_rest(&view);
/// importance.look(&onlooker, &parameters.weights(onlooker.state));
///
/// let fine: Vec<u8> = (0..64 * 32).map(|i| if i % 4 < 2 { 90 } else { 160 }).collect();
/// let coarse = vec![125; 64 * 32];
/// let left_or_right: Vec<u32> = (0..64 * 32).map(|i| i % 64 / 32).collect();
/// let mut gains = [0.0; 2];
/// importance.unit_gains(&[&fine, &coarse], &left_or_right, &mut gains);
/// assert!(gains[0] > 0.0 && gains[1] > 0.0);
/// ```
pub struct FastImportance {
    size: [usize; 2],
    levels: usize,
    luma: [f32; 256],
    omega: f32,
    popping: f32,
    /// Whether pixels are worth something besides their bands.
    offset_counts: bool,
    instructions: Instructions,
    field: EyeField,
    bands: Vec<[usize; 2]>,
    /// `[picture][band]`: the level below each band.
    below: Vec<Vec<Vec<f32>>>,
    /// `[band][step]`: value added up from the coarsest band to this one; in band 0 a row, of that
    /// band or of the coarser ones.
    sums: Vec<Vec<Vec<f32>>>,
    scratch: Scratch,
}

/// Rows that are written before they are read.
struct Scratch {
    /// `[picture][row modulo DECODED]`: padded rows of luminance.
    decoded: Vec<[Vec<f32>; DECODED]>,
    padded: Vec<f32>,
    contrast: Vec<Vec<f32>>,
    nodes: [Vec<f32>; 2],
    seen: [Vec<f32>; 2],
    whole: [Vec<f32>; 2],
}

impl FastImportance {
    /// For `levels` pictures of the view's size. Costs about 0.1 s, once.
    #[must_use]
    pub fn new(parameters: &Parameters, view: &EyeView, levels: usize) -> Self {
        let mut bands = Vec::new();
        let mut band_size = view.size;
        for _ in 0..bands_of(view.size) {
            bands.push(band_size.map(|side| side as usize));
            band_size = half_size(band_size);
        }
        let size = view.size.map(|side| side as usize);
        let plane = |[w, h]: [usize; 2]| vec![0.0_f32; w * h];
        let below = |&size: &[usize; 2]| plane(size.map(|side| side.div_ceil(2)));
        let steps = levels.saturating_sub(1);
        let sum = |(band, &[w, h]): (usize, &[usize; 2])| {
            let rows = if band == 0 { 1 } else { h };
            vec![plane([w, rows]); steps]
        };
        Self {
            size,
            levels,
            luma: parameters.luma_table().map(|luminance| luminance as f32),
            omega: parameters.omega as f32,
            popping: 0.0,
            offset_counts: false,
            instructions: Instructions::widest(),
            field: EyeField::new(parameters, view, bands.len()),
            below: vec![bands.iter().map(below).collect(); levels],
            sums: bands.iter().enumerate().map(sum).collect(),
            scratch: Scratch::new(size[0], levels),
            bands,
        }
    }

    /// Looks somewhere, and weighs as given ([`Parameters::weights`]).
    ///
    /// # Panics
    /// When the view is not of the size that this was made for.
    pub fn look(&mut self, onlooker: &Onlooker, weights: &Weights) {
        let size = onlooker.view.size.map(|side| side as usize);
        assert!(size == self.size, "the view that this was made for");
        self.popping = weights.popping as f32;
        self.offset_counts = weights.acuity != 0.0 || weights.constant != 0.0;
        self.field.look(onlooker, weights);
    }

    /// Value of every step and unit for 8-bit luma pictures, the finest first: `gains[step * units
    /// + unit]`, step i from picture i + 1 to picture i.
    ///
    /// # Panics
    /// When the number of pictures, of pixels or of ids is not as set up, `gains` is no multiple of
    /// the steps, or an id is neither below the number of units nor [`NO_UNIT`].
    pub fn unit_gains(&mut self, levels: &[&[u8]], unit_ids: &[u32], gains: &mut [f64]) {
        let [width, height] = self.size;
        let steps = self.levels - 1;
        assert!(unit_ids.len() == width * height, "one id for every pixel");
        assert!(gains.len().is_multiple_of(steps), "units for every step");
        let units = gains.len() / steps;
        gains.fill(0.0);
        self.instructions.run(
            #[inline(always)]
            || {
                self.each_row(
                    levels,
                    #[inline(always)]
                    |row| {
                        let ids = &unit_ids[row.y * width..][row.span.clone()];
                        units::add_row(row.values(), row.factor, ids, gains, units);
                    },
                );
            },
        );
    }

    /// Value of every pixel for every step, row by row: `maps[step]`.
    ///
    /// # Panics
    /// When pictures or maps are not as set up.
    pub fn maps(&mut self, levels: &[&[u8]], maps: &mut [Vec<f32>]) {
        let width = self.size[0];
        for map in maps.iter_mut() {
            map.fill(0.0);
        }
        self.instructions.run(
            #[inline(always)]
            || {
                self.each_row(
                    levels,
                    #[inline(always)]
                    |row| {
                        for (map, values) in maps.iter_mut().zip(row.values()) {
                            let map = &mut map[row.y * width..][row.span.clone()];
                            rows::add_products(values, row.factor, map);
                        }
                    },
                );
            },
        );
    }
}

impl Scratch {
    fn new(width: usize, levels: usize) -> Self {
        let row = || vec![0.0; width];
        let padded = || vec![0.0; width + 2 * PAD];
        let nodes = || vec![0.0; width.div_ceil(SPACING) + 1];
        Self {
            decoded: (0..levels)
                .map(|_| core::array::from_fn(|_| padded()))
                .collect(),
            padded: padded(),
            contrast: vec![row(); levels],
            nodes: [nodes(), nodes()],
            seen: [row(), row()],
            whole: [row(), row()],
        }
    }
}

#[cfg(test)]
mod tests;
