//! In which order is a decision worked out, so that little is read twice?
//!
//! Down: rows of all pictures are decoded once; each is halved and, as soon as the level below it
//! is there, worth what its finest band is. Then the coarser bands, from the coarsest up, and last
//! what they come to at every pixel.

use super::field::{SPACING, band_stride, texels_per_node};
use super::rows::{self, PAD, SeenRow};
use super::{DECODED, FastImportance, Scratch};
use crate::perception::measures::pyramid::four_around;
use core::ops::Range;

/// A part of what pixels of a row are worth: parts add up.
pub(super) struct PartRow<'a> {
    pub(super) y: usize,
    /// Pixels that this is about.
    pub(super) span: Range<usize>,
    steps: &'a [Vec<f32>],
    /// What each pixel's value is multiplied by.
    pub(super) factor: &'a [f32],
}

impl<'a> PartRow<'a> {
    /// By step, values of the pixels of the span.
    #[inline(always)]
    pub(super) fn values(&self) -> impl Iterator<Item = &'a [f32]> + Clone + use<'a> {
        let span = self.span.clone();
        self.steps.iter().map(move |row| &row[span.clone()])
    }
}

impl FastImportance {
    /// Gives all parts of all rows to `sink`.
    #[inline(always)]
    pub(super) fn each_row(&mut self, levels: &[&[u8]], mut sink: impl FnMut(PartRow<'_>)) {
        let [width, height] = self.size;
        assert!(levels.len() == self.levels, "as many pictures as set up");
        let whole = levels.iter().all(|luma| luma.len() == width * height);
        assert!(whole, "one value for every pixel");
        self.finest_band(levels, &mut sink);
        for band in 1..self.bands.len() {
            for picture in 0..self.levels {
                self.halve(picture, band);
            }
        }
        for band in (1..self.bands.len()).rev() {
            for y in 0..self.bands[band][1] {
                self.band_row(band, y);
            }
        }
        for y in 0..height {
            self.coarser_bands(y);
            sink(self.part(y, 0..width));
        }
    }

    /// Decodes and halves all pictures, and gives what their finest band is worth to `sink`.
    #[inline(always)]
    fn finest_band(&mut self, levels: &[&[u8]], sink: &mut impl FnMut(PartRow<'_>)) {
        let Some(&[_, height]) = self.bands.first() else {
            return;
        };
        let half_height = height.div_ceil(2);
        for y in 0..=half_height {
            if y < half_height {
                for (picture, luma) in levels.iter().enumerate() {
                    self.decode_and_halve(picture, luma, y);
                }
            }
            // Doubling takes the next row of the level below.
            for fine in (2 * y).saturating_sub(2)..height.min(2 * y) {
                let span = self.band_row(0, fine);
                self.whole_row(fine);
                sink(self.part(fine, span));
            }
        }
    }

    fn part(&self, y: usize, span: Range<usize>) -> PartRow<'_> {
        PartRow {
            y,
            factor: &self.scratch.whole[1][span.clone()],
            span,
            steps: &self.sums[0],
        }
    }

    /// Builds a row of the level below the finest band of one picture.
    #[inline(always)]
    fn decode_and_halve(&mut self, picture: usize, luma: &[u8], y: usize) {
        let [width, height] = self.size;
        let Scratch {
            decoded, padded, ..
        } = &mut self.scratch;
        let decoded = &mut decoded[picture];
        let first_new = if y == 0 { 0 } else { 2 * y + 1 };
        for row in first_new..height.min(2 * y + 3) {
            let luma = &luma[row * width..][..width];
            rows::decode(luma, &self.luma, &mut decoded[row % DECODED]);
        }
        let four = four_around(y, height).map(|row| decoded[row % DECODED].as_slice());
        rows::halve_rows(four, padded);
        let half = width.div_ceil(2);
        rows::halve(padded, &mut self.below[picture][0][y * half..][..half]);
    }

    /// Builds the level below a coarser band of one picture.
    #[inline(always)]
    fn halve(&mut self, picture: usize, band: usize) {
        let [width, height] = self.bands[band];
        let half = width.div_ceil(2);
        let padded = &mut self.scratch.padded[..width + 2 * PAD];
        let (above, below) = self.below[picture].split_at_mut(band);
        let above = &above[band - 1];
        for (y, out) in below[0].chunks_exact_mut(half).enumerate() {
            let four = four_around(y, height).map(|row| &above[row * width..][..width]);
            rows::halve_rows(four, &mut padded[PAD..PAD + width]);
            rows::repeat_border(padded, width);
            rows::halve(padded, out);
        }
    }

    /// Adds what one row of a band is worth in every step to what the coarser bands are (to nothing
    /// in the finest band). Returns the texels of which something is seen.
    #[inline(always)]
    fn band_row(&mut self, band: usize, y: usize) -> Range<usize> {
        let size = self.bands[band];
        let width = size[0];
        let span = self.seen_row(band, y);
        self.contrast_row(band, y, span.clone());
        let (finer, coarser) = self.sums.split_at_mut(band + 1);
        let Scratch {
            padded,
            contrast,
            seen,
            ..
        } = &mut self.scratch;
        let seen = SeenRow {
            error: &seen[0][span.clone()],
            transient: &seen[1][span.clone()],
            popping: self.popping,
            omega: self.omega,
        };
        for (step, sum) in finer[band].iter_mut().enumerate() {
            let start = if band == 0 { 0 } else { y * width };
            let sum = &mut sum[start..][..width];
            match coarser.first().filter(|_| band > 0) {
                Some(below) => double_into(&below[step], size, y, padded, 0, sum),
                None => sum.fill(0.0),
            }
            let [before, after] = [step + 1, step].map(|picture| &contrast[picture][span.clone()]);
            rows::add_gain(seen, before, after, &mut sum[span.clone()]);
        }
        span
    }

    /// Contrasts of all pictures along a part of a row of a band.
    #[inline(always)]
    fn contrast_row(&mut self, band: usize, y: usize, span: Range<usize>) {
        let size = self.bands[band];
        let Scratch {
            decoded,
            padded,
            contrast,
            ..
        } = &mut self.scratch;
        for (picture, contrast) in contrast.iter_mut().enumerate() {
            let contrast = &mut contrast[span.clone()];
            let below = &self.below[picture];
            double_into(&below[band], size, y, padded, span.start, contrast);
            let fine = if band == 0 {
                &decoded[picture][y % DECODED][PAD..]
            } else {
                &below[band - 1][y * size[0]..]
            };
            rows::contrast(&fine[span.clone()], contrast);
        }
    }

    /// Sensitivities along a row of a band. Returns the texels outside of which all are 0, from an
    /// even one on; there nothing is written.
    #[inline(always)]
    pub(super) fn seen_row(&mut self, band: usize, y: usize) -> Range<usize> {
        let width = self.bands[band][0];
        let (stride, per_node) = (band_stride(band), texels_per_node(band));
        let size = self.field.size();
        let Scratch { nodes, seen, .. } = &mut self.scratch;
        let planes = self.field.bands[band].iter();
        if stride > 1 {
            let middle = |texel: usize| stride * texel + stride / 2;
            for (plane, out) in planes.zip(seen) {
                let row = &plane[middle(y).min(size[1] - 1) * size[0]..][..size[0]];
                for (x, value) in out[..width].iter_mut().enumerate() {
                    *value = row[middle(x).min(size[0] - 1)];
                }
            }
            return 0..width;
        }
        for (plane, nodes) in planes.zip(nodes.iter_mut()) {
            node_row(plane, size, per_node, y, nodes);
        }
        let near = self.field.near_gaze(band, y, width);
        let cells = seen_cells(nodes, per_node, &near);
        let span = cells.start * per_node..width.min(cells.end * per_node);
        for (nodes, out) in nodes.iter().zip(seen.iter_mut()) {
            rows::spread_nodes(&nodes[cells.start..], per_node, &mut out[span.clone()]);
        }
        self.field.refine_row(band, y, near, seen);
        span
    }

    /// Factors of a row of pixels, and what they are worth besides their bands.
    #[inline(always)]
    fn whole_row(&mut self, y: usize) {
        let Scratch { nodes, whole, .. } = &mut self.scratch;
        let unused = usize::from(!self.offset_counts);
        let planes = self.field.whole.iter().zip(whole.iter_mut());
        for (plane, out) in planes.skip(unused) {
            node_row(plane, self.field.size(), SPACING, y, &mut nodes[0]);
            rows::spread_nodes(&nodes[0], SPACING, out);
        }
        self.field.refine_whole(y, whole);
    }

    /// What a row of pixels is worth but for its finest band.
    #[inline(always)]
    fn coarser_bands(&mut self, y: usize) {
        self.whole_row(y);
        let (pixels, coarser) = self.sums.split_at_mut(1);
        let Scratch { padded, whole, .. } = &mut self.scratch;
        for (step, sum) in pixels[0].iter_mut().enumerate() {
            match coarser.first() {
                Some(below) => double_into(&below[step], self.size, y, padded, 0, sum),
                None => sum.fill(0.0),
            }
            if self.offset_counts {
                rows::add(&whole[0], sum);
            }
        }
    }
}

/// Cells between nodes, from an even one on, outside of which both rows of nodes are 0 and no texel
/// is in `near`.
fn seen_cells(nodes: &[Vec<f32>; 2], per_node: usize, near: &Range<usize>) -> Range<usize> {
    let any = |node: &usize| nodes[0][*node] != 0.0 || nodes[1][*node] != 0.0;
    let last_cell = nodes[0].len() - 1;
    let first = (0..=last_cell).find(any).unwrap_or(last_cell);
    let last = (first..=last_cell).rfind(any).unwrap_or(first);
    let (mut start, mut end) = (first.saturating_sub(1), last_cell.min(last + 1));
    if !near.is_empty() {
        start = start.min(near.start / per_node);
        end = end.max(near.end.div_ceil(per_node));
    }
    start & !1..end
}

/// Row `y` of a plane of nodes, between its rows.
#[inline(always)]
fn node_row(plane: &[f32], size: [usize; 2], per_node: usize, y: usize, out: &mut [f32]) {
    let (node, within) = (y / per_node, y % per_node);
    let share = (within as f32 + 0.5) / per_node as f32;
    let row = |node: usize| &plane[node * size[0]..][..size[0]];
    rows::mix(row(node), row(node + 1), share, out);
}

/// Row `y` of a plane at twice its size, `[w, h]` fine samples, from the even sample `start` on.
#[inline(always)]
fn double_into(
    plane: &[f32],
    [w, h]: [usize; 2],
    y: usize,
    padded: &mut [f32],
    start: usize,
    out: &mut [f32],
) {
    let [cw, ch] = [w, h].map(|side| side.div_ceil(2));
    let near = y / 2;
    let far = if y.is_multiple_of(2) {
        near.saturating_sub(1)
    } else {
        (near + 1).min(ch - 1)
    };
    let row = |y: usize| &plane[y * cw..][..cw];
    let padded = &mut padded[..cw + 2 * PAD];
    let first = (start / 2).saturating_sub(1);
    let last = cw.min((start + out.len()) / 2 + 2);
    rows::double_rows(row(near), row(far), first..last.max(first), padded);
    rows::double(&padded[start / 2..], out);
}
