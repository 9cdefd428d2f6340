//! What is every step worth to every unit, many times a second?
//!
//! The importance of [`super::importance`] in single precision on one thread: sensitivities from
//! tables at nodes, every picture's pyramid built once, one division per pixel of a picture and one
//! per step, rows as plain slices. After set-up nothing is allocated.

mod field;
mod rows;

use super::gain::Weights;
use super::importance::{NO_UNIT, Onlooker};
use super::parameters::Parameters;
use super::pyramid::{bands_of, half_size};
use crate::view::eye_view::EyeView;
use field::{EyeField, SPACING, band_stride, texels_per_node};
use rows::{PAD, SeenRow};

/// Pixels whose ids are compared together.
const CHUNK: usize = 8;

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
/// let view = EyeView { axes: Axes::FRONT, field, size };
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
    field: EyeField,
    bands: Vec<[usize; 2]>,
    /// `[picture][band]`: the level below each band.
    below: Vec<Vec<Vec<f32>>>,
    /// `[band][step]`: value added up from the coarsest band to this one; band 0 is a row.
    sums: Vec<Vec<Vec<f32>>>,
    scratch: Scratch,
}

/// Rows that are written before they are read.
struct Scratch {
    fine: Vec<f32>,
    half: [Vec<f32>; 4],
    doubled: Vec<f32>,
    contrast: Vec<Vec<f32>>,
    nodes: Vec<f32>,
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
            field: EyeField::new(parameters, view, bands.len()),
            below: vec![bands.iter().map(below).collect(); levels],
            sums: bands.iter().enumerate().map(sum).collect(),
            scratch: Scratch::new(size[0], levels),
            bands,
        }
    }

    /// Looks somewhere, and weighs as told ([`Parameters::weights`]).
    ///
    /// # Panics
    /// When the view is not of the size that this was made for.
    pub fn look(&mut self, onlooker: &Onlooker, weights: &Weights) {
        let size = onlooker.view.size.map(|side| side as usize);
        assert!(size == self.size, "the view that this was made for");
        self.popping = weights.popping as f32;
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
        self.each_row(levels, |y, values| {
            let ids = &unit_ids[y * width..][..width];
            add_rows(values, ids, units, gains);
        });
    }

    /// Value of every pixel for every step, row by row: `maps[step]`.
    ///
    /// # Panics
    /// When pictures or maps are not as set up.
    pub fn maps(&mut self, levels: &[&[u8]], maps: &mut [Vec<f32>]) {
        let width = self.size[0];
        self.each_row(levels, |y, values| {
            for (map, row) in maps.iter_mut().zip(values) {
                map[y * width..][..width].copy_from_slice(row);
            }
        });
    }

    fn each_row(&mut self, levels: &[&[u8]], mut sink: impl FnMut(usize, &[Vec<f32>])) {
        let [width, height] = self.size;
        assert!(levels.len() == self.levels, "as many pictures as set up");
        let whole = levels.iter().all(|luma| luma.len() == width * height);
        assert!(whole, "one value for every pixel");
        for (picture, luma) in levels.iter().enumerate() {
            for band in 0..self.bands.len() {
                self.halve(picture, luma, band);
            }
        }
        for band in (0..self.bands.len()).rev() {
            for y in 0..self.bands[band][1] {
                self.band_row(levels, band, y);
                if band == 0 {
                    self.finish_row(y);
                    sink(y, &self.sums[0]);
                }
            }
        }
    }

    /// Builds the level below `band` of one picture.
    fn halve(&mut self, picture: usize, luma: &[u8], band: usize) {
        let [width, height] = self.bands[band];
        let half = width.div_ceil(2);
        let Scratch {
            fine, half: rows, ..
        } = &mut self.scratch;
        let fine = &mut fine[..width + 2 * PAD];
        let (above, below) = self.below[picture].split_at_mut(band);
        let mut next = 0;
        for y in 0..height.div_ceil(2) {
            while next < height.min(2 * y + 3) {
                if band == 0 {
                    rows::decode(&luma[next * width..][..width], &self.luma, fine);
                } else {
                    let row = &above[band - 1][next * width..][..width];
                    fine[PAD..PAD + width].copy_from_slice(row);
                    rows::repeat_border(fine, width);
                }
                rows::halve(fine, &mut rows[next % 4][..half]);
                next += 1;
            }
            let last = height - 1;
            let four = [(2 * y).saturating_sub(1), 2 * y, 2 * y + 1, 2 * y + 2];
            let four = four.map(|row| &rows[row.min(last) % 4][..half]);
            rows::halve_rows(four, &mut below[0][y * half..][..half]);
        }
    }

    /// Adds what one row of a band is worth in every step to what the coarser bands are.
    fn band_row(&mut self, levels: &[&[u8]], band: usize, y: usize) {
        let size = self.bands[band];
        let width = size[0];
        let Scratch {
            fine,
            doubled,
            contrast,
            ..
        } = &mut self.scratch;
        for (picture, contrast) in contrast.iter_mut().enumerate() {
            let contrast = &mut contrast[..width];
            double_into(&self.below[picture][band], size, y, doubled, contrast);
            if band == 0 {
                rows::decode(&levels[picture][y * width..][..width], &self.luma, fine);
                rows::contrast(&fine[PAD..PAD + width], contrast);
            } else {
                rows::contrast(
                    &self.below[picture][band - 1][y * width..][..width],
                    contrast,
                );
            }
        }
        self.seen_row(band, y);
        let (finer, coarser) = self.sums.split_at_mut(band + 1);
        let Scratch {
            doubled,
            contrast,
            seen,
            ..
        } = &mut self.scratch;
        let seen = SeenRow {
            error: &seen[0],
            transient: &seen[1],
            popping: self.popping,
            omega: self.omega,
        };
        for (step, sum) in finer[band].iter_mut().enumerate() {
            let start = if band == 0 { 0 } else { y * width };
            let sum = &mut sum[start..][..width];
            match coarser.first() {
                Some(below) => double_into(&below[step], size, y, doubled, sum),
                None => sum.fill(0.0),
            }
            rows::add_gain(seen, &contrast[step + 1], &contrast[step], sum);
        }
    }

    /// Sensitivities along a row of a band.
    fn seen_row(&mut self, band: usize, y: usize) {
        let (width, Scratch { nodes, seen, .. }) = (self.bands[band][0], &mut self.scratch);
        let size = self.field.size();
        let planes = &self.field.bands[band];
        for (plane, out) in planes.iter().zip(seen.iter_mut()) {
            let (stride, per_node) = (band_stride(band), texels_per_node(band));
            if stride == 1 {
                node_row(plane, size, per_node, y, nodes);
                rows::spread_nodes(nodes, per_node, &mut out[..width]);
            } else {
                let middle = |texel: usize| stride * texel + stride / 2;
                let row = &plane[middle(y).min(size[1] - 1) * size[0]..][..size[0]];
                for (x, value) in out[..width].iter_mut().enumerate() {
                    *value = row[middle(x).min(size[0] - 1)];
                }
            }
        }
        self.field.refine_row(band, y, seen, width);
    }

    /// Makes pixels' values of what their bands add up to.
    fn finish_row(&mut self, y: usize) {
        let Scratch { nodes, whole, .. } = &mut self.scratch;
        for (plane, out) in self.field.whole.iter().zip(whole.iter_mut()) {
            node_row(plane, self.field.size(), SPACING, y, nodes);
            rows::spread_nodes(nodes, SPACING, out);
        }
        self.field.refine_whole(y, whole);
        let [offset, factor] = whole;
        for sum in &mut self.sums[0] {
            let terms = offset.iter().zip(factor.iter());
            for (value, (offset, factor)) in sum.iter_mut().zip(terms) {
                *value = (*value + offset) * factor;
            }
        }
    }
}

impl Scratch {
    fn new(width: usize, levels: usize) -> Self {
        let row = || vec![0.0; width];
        Self {
            fine: vec![0.0; width + 2 * PAD],
            half: [row(), row(), row(), row()],
            doubled: vec![0.0; width + 2 * PAD],
            contrast: vec![row(); levels],
            nodes: vec![0.0; width.div_ceil(SPACING) + 1],
            seen: [row(), row()],
            whole: [row(), row()],
        }
    }
}

/// Row `y` of a plane of nodes, between its rows.
fn node_row(plane: &[f32], size: [usize; 2], per_node: usize, y: usize, out: &mut [f32]) {
    let (node, within) = (y / per_node, y % per_node);
    let share = (within as f32 + 0.5) / per_node as f32;
    let row = |node: usize| &plane[node * size[0]..][..size[0]];
    rows::mix(row(node), row(node + 1), share, out);
}

/// Row `y` of a plane at twice its size, `[w, h]` fine samples.
fn double_into(plane: &[f32], [w, h]: [usize; 2], y: usize, padded: &mut [f32], out: &mut [f32]) {
    let [cw, ch] = [w, h].map(|side| side.div_ceil(2));
    let near = y / 2;
    let far = if y.is_multiple_of(2) {
        near.saturating_sub(1)
    } else {
        (near + 1).min(ch - 1)
    };
    let row = |y: usize| &plane[y * cw..][..cw];
    let padded = &mut padded[..cw + 2 * PAD];
    rows::double_rows(row(near), row(far), padded);
    rows::double(padded, out);
}

/// Adds a row of every step to the sums of its units, whole chunks where one unit has them.
fn add_rows(rows: &[Vec<f32>], unit_ids: &[u32], units: usize, sums: &mut [f64]) {
    let (chunks, rest) = unit_ids.as_chunks::<CHUNK>();
    for (index, ids) in chunks.iter().enumerate() {
        let mixed = ids.iter().fold(0, |mixed, id| mixed | (id ^ ids[0]));
        let start = index * CHUNK;
        if mixed != 0 {
            add_pixels(rows, start, ids, units, sums);
        } else if ids[0] != NO_UNIT {
            let unit = ids[0] as usize;
            assert!(unit < units, "an id of a unit");
            for (step, row) in rows.iter().enumerate() {
                let Some(values) = row[start..].first_chunk::<CHUNK>() else {
                    continue;
                };
                let [a, b, c, d]: [f32; 4] = core::array::from_fn(|i| values[i] + values[i + 4]);
                sums[step * units + unit] += f64::from((a + b) + (c + d));
            }
        }
    }
    add_pixels(rows, unit_ids.len() - rest.len(), rest, units, sums);
}

fn add_pixels(rows: &[Vec<f32>], start: usize, ids: &[u32], units: usize, sums: &mut [f64]) {
    for (offset, &id) in ids.iter().enumerate() {
        if id == NO_UNIT {
            continue;
        }
        let unit = id as usize;
        assert!(unit < units, "an id of a unit");
        for (step, row) in rows.iter().enumerate() {
            sums[step * units + unit] += f64::from(row[start + offset]);
        }
    }
}

#[cfg(test)]
mod tests;
