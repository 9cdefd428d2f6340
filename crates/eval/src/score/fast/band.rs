//! How visible is the difference of two pictures in one band?
//!
//! The statements of [`crate::score::clear`] in single precision, a row at a time, with powers as
//! logarithms. Strips of rows are summed up by themselves and added in their order, so the result
//! does not depend on the number of threads.

use super::eye::{BandEye, GazeRay, Table};
use super::levels::Levels;
use super::math::{exp2, log2, split};
use super::strip::ROWS;
use crate::score::constants::{
    CHANNEL_WEIGHTS, COARSE_BAND_GAIN, DIFFERENCE_EXPONENT, LEAST_ADAPTATION, MASKING,
    MASKING_EXPONENTS, MOST_CONTRAST, MOST_DIFFERENCE, SENSITIVITY_FACTOR, SPACE_EXPONENT,
};
use crate::score::pooling::{BandSums, ZONE_BORDERS_DEG, ZONES};
use foveal_core::perception::fast::instructions::Instructions;
use rayon::prelude::*;

/// Lanes that sums are kept in.
const LANES: usize = 8;
/// Stands for a difference of nothing, whose logarithm must be finite.
const TINY: f32 = 1e-30;

/// One band of one frame.
pub(super) struct BandPass<'a> {
    /// Number of the band: its level and the one below are looked at.
    pub(super) band: usize,
    pub(super) table: &'a Table,
    pub(super) eye: &'a BandEye,
    pub(super) looking: GazeRay,
    /// By channel: reference and test.
    pub(super) channels: &'a [[Levels; 2]],
    pub(super) instructions: Instructions,
}

/// Rows that are worked on.
struct Scratch {
    upright: Vec<f32>,
    eccentricity: Vec<f32>,
    adaptation: Vec<f32>,
    frequency: Vec<f32>,
    across: Vec<(u32, f32)>,
    deep: Vec<(u32, f32)>,
    /// Log2 of the sensitivities of both channels.
    seen: [Vec<f32>; 2],
    coarse: [Vec<f32>; 2],
    /// Log2 of the difference, and the difference to the power of pooling.
    difference: Vec<f32>,
    pooled: Vec<f32>,
}

impl Scratch {
    fn new(columns: usize) -> Self {
        let row = || vec![0.0; columns];
        Self {
            upright: row(),
            eccentricity: row(),
            adaptation: row(),
            frequency: row(),
            across: vec![(0, 0.0); columns],
            deep: vec![(0, 0.0); columns],
            seen: [row(), row()],
            coarse: [row(), row()],
            difference: row(),
            pooled: row(),
        }
    }
}

impl BandPass<'_> {
    /// The sums over the band. `heat`, if it has the band's pixels, gets their part of the heat
    /// map.
    pub(super) fn sums(&self, heat: &mut [f32]) -> BandSums {
        let [columns, rows] = self.eye.size;
        let strips: Vec<BandSums> = if heat.is_empty() {
            let strips = (0..rows.div_ceil(ROWS)).into_par_iter();
            strips.map(|strip| self.strip(strip, &mut [])).collect()
        } else {
            let strips = heat.par_chunks_mut(columns * ROWS).enumerate();
            strips
                .map(|(strip, heat)| self.strip(strip, heat))
                .collect()
        };
        let mut sums = BandSums::default();
        strips.iter().for_each(|strip| sums.add(strip));
        sums
    }

    fn strip(&self, strip: usize, heat: &mut [f32]) -> BandSums {
        let [columns, rows] = self.eye.size;
        let mut scratch = Scratch::new(columns);
        let mut sums = BandSums::default();
        self.instructions.run(
            #[inline(always)]
            || {
                for y in strip * ROWS..((strip + 1) * ROWS).min(rows) {
                    let heat = heat.chunks_exact_mut(columns).nth(y - strip * ROWS);
                    self.row(y, &mut scratch, heat.unwrap_or_default(), &mut sums);
                }
            },
        );
        sums
    }

    #[inline(always)]
    fn row(&self, y: usize, rows: &mut Scratch, heat: &mut [f32], sums: &mut BandSums) {
        self.eye
            .eccentricities(y, &self.looking, &mut rows.eccentricity);
        self.eye.frequencies(y, &mut rows.frequency);
        let adapting = &self.channels[0][0];
        adapting.expand_row(self.band + 1, y, &mut rows.upright, &mut rows.coarse[0]);
        self.find_places(rows);
        if self.table.raised.is_empty() {
            self.look_up_deep(rows);
        } else {
            self.look_up_raised(rows);
        }
        count_zones(&rows.eccentricity, &mut sums.pixels);
        for (channel, levels) in self.channels.iter().enumerate() {
            for (levels, coarse) in levels.iter().zip(&mut rows.coarse) {
                levels.expand_row(self.band + 1, y, &mut rows.upright, coarse);
            }
            self.compare(channel, levels, y, rows);
            add_zones(&rows.eccentricity, &rows.pooled, |zone, sum| {
                sums.sums[zone][channel] += sum;
            });
            let weight = CHANNEL_WEIGHTS[channel] as f32 / self.gain();
            for (heat, difference) in heat.iter_mut().zip(&rows.difference) {
                *heat += weight * exp2(*difference);
            }
        }
    }

    fn gain(&self) -> f32 {
        if self.band == 0 {
            1.0
        } else {
            COARSE_BAND_GAIN as f32
        }
    }

    /// Luminance that the eye is adapted to, and places in the table.
    #[inline(always)]
    fn find_places(&self, rows: &mut Scratch) {
        let adapted = rows.adaptation.iter_mut().zip(&mut rows.across);
        for ((adaptation, across), light) in adapted.zip(&rows.coarse[0]) {
            *adaptation = light.max(LEAST_ADAPTATION as f32);
            *across = self.table.across(log2(*adaptation));
        }
        for (deep, eccentricity) in rows.deep.iter_mut().zip(&rows.eccentricity) {
            *deep = self.table.deep(*eccentricity);
        }
    }

    /// From the table over luminance, frequency and eccentricity.
    #[inline(always)]
    fn look_up_deep(&self, rows: &mut Scratch) {
        let table = self.table;
        let [s, t] = &mut rows.seen;
        let places = rows.across.iter().zip(&rows.deep).zip(&rows.frequency);
        for ((((across, deep), frequency), s), t) in places.zip(s).zip(t) {
            let (y, share) = split(frequency.clamp(0.0, table.most_frequency));
            let row = deep.0 as usize * table.frequencies + y as usize;
            let near = table.pair(row, across.0, share);
            let far = table.pair(row + table.frequencies, across.0, share);
            [*s, *t] = along(mixed(near, far, deep.1), across.1);
        }
    }

    /// From the table over luminance and frequency at the cortex.
    #[inline(always)]
    fn look_up_raised(&self, rows: &mut Scratch) {
        let table = self.table;
        let [s, t] = &mut rows.seen;
        let places = rows.across.iter().zip(&rows.deep).zip(&rows.frequency);
        for ((((across, deep), frequency), s), t) in places.zip(s).zip(t) {
            let (low, high) = (
                table.raised[deep.0 as usize],
                table.raised[deep.0 as usize + 1],
            );
            let raised = low + (high - low) * deep.1;
            let (y, share) = split((frequency + raised).clamp(0.0, table.most_frequency));
            [*s, *t] = along(table.pair(y as usize, across.0, share), across.1);
        }
    }

    /// Differences of a channel in a row.
    #[inline(always)]
    fn compare(&self, channel: usize, levels: &[Levels; 2], y: usize, rows: &mut Scratch) {
        let w = rows.adaptation.len();
        let fine = |k: usize| &levels[k].planes[self.band][y * w..][..w];
        let (reference, test) = (fine(0), fine(1));
        let (below_reference, below_test) = (&rows.coarse[0][..w], &rows.coarse[1][..w]);
        let (adaptation, seen) = (&rows.adaptation[..w], &rows.seen[channel][..w]);
        let factor = (SENSITIVITY_FACTOR.log2()) as f32;
        let (gain, most) = (self.gain(), MOST_CONTRAST as f32);
        let exponent = MASKING_EXPONENTS[channel] as f32;
        let most_difference = MOST_DIFFERENCE.log2() as f32;
        let results = rows.difference[..w].iter_mut().zip(&mut rows.pooled[..w]);
        for (x, (difference, pooled)) in results.enumerate() {
            let adapted = 1.0 / adaptation[x];
            let strength = exp2(seen[x] + factor) * gain;
            let r = ((reference[x] - below_reference[x]) * adapted).min(most) * strength;
            let t = ((test[x] - below_test[x]) * adapted).min(most) * strength;
            let apart = (t - r).abs();
            let mask = MASKING as f32 * r.abs().min(t.abs());
            let masked = 1.0 + exp2(exponent * log2(mask.max(TINY)));
            let raw = DIFFERENCE_EXPONENT as f32 * log2(apart.max(TINY)) - log2(masked);
            *difference = raw.min(most_difference);
            let sum = exp2(SPACE_EXPONENT as f32 * *difference);
            *pooled = if apart > 0.0 { sum } else { 0.0 };
        }
    }
}

/// Entries of both channels at two neighbouring luminances.
type Pair = [f32; 4];

impl Table {
    /// Between row `row` of the table and the next.
    #[inline(always)]
    fn pair(&self, row: usize, across: u32, share: f32) -> Pair {
        let at = |row: usize| -> Pair {
            let first = (row * self.luminances + across as usize) * 2;
            let four = &self.entries[first..first + 4];
            [four[0], four[1], four[2], four[3]]
        };
        mixed(at(row), at(row + 1), share)
    }
}

#[inline(always)]
fn mixed(near: Pair, far: Pair, share: f32) -> Pair {
    // Written out: a closure over the array is not inlined, and called for every pixel.
    [
        near[0] + (far[0] - near[0]) * share,
        near[1] + (far[1] - near[1]) * share,
        near[2] + (far[2] - near[2]) * share,
        near[3] + (far[3] - near[3]) * share,
    ]
}

#[inline(always)]
fn along(pair: Pair, share: f32) -> [f32; 2] {
    [
        pair[0] + (pair[2] - pair[0]) * share,
        pair[1] + (pair[3] - pair[1]) * share,
    ]
}

/// Adds up a row by zone.
#[inline(always)]
fn add_zones(eccentricity: &[f32], values: &[f32], mut add: impl FnMut(usize, f64)) {
    let [near, far] = ZONE_BORDERS_DEG.map(|border| border as f32);
    let mut lanes = [[0.0_f32; LANES]; ZONES];
    let chunks = eccentricity.chunks(LANES).zip(values.chunks(LANES));
    for (e, v) in chunks {
        for (lane, (e, v)) in e.iter().zip(v).enumerate() {
            lanes[0][lane] += if *e < near { *v } else { 0.0 };
            lanes[1][lane] += if *e >= near && *e < far { *v } else { 0.0 };
            lanes[2][lane] += if *e >= far { *v } else { 0.0 };
        }
    }
    for (zone, lanes) in lanes.iter().enumerate() {
        add(zone, lanes.iter().map(|lane| f64::from(*lane)).sum());
    }
}

#[inline(always)]
fn count_zones(eccentricity: &[f32], pixels: &mut [f64; ZONES]) {
    let [near, far] = ZONE_BORDERS_DEG.map(|border| border as f32);
    let mut beyond = [0_u32; 2];
    for e in eccentricity {
        beyond[0] += u32::from(*e >= near);
        beyond[1] += u32::from(*e >= far);
    }
    pixels[0] += eccentricity.len() as f64 - f64::from(beyond[0]);
    pixels[1] += f64::from(beyond[0] - beyond[1]);
    pixels[2] += f64::from(beyond[1]);
}
