//! How much contrast does a unit of points add to those that it is shown in place of?
//!
//! Measured where points lie, not in pictures: a cell of the coarser unit is a pixel, and octaves
//! are cells of twice the size each.

use super::stretches::{cell_ends, common_depth};
use foveal_core::content::points::payload::{CloudPoint, PointAttributes};
use foveal_core::perception::measures::contrast::{BandContrast, SIGNATURE_BANDS, Signature};
use foveal_core::perception::parameters::Parameters;

/// Weights of red, green and blue codes in luma. ITU-R BT.709, 3.2.
const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// What turns points into luminance on the default display.
pub(super) struct Light {
    table: [f64; 256],
    attributes: PointAttributes,
    /// What makes codes, or intensities, eight bits.
    scale: f64,
}

impl Light {
    /// Of points whose codes have so many bits, and whose intensities go up to so much.
    pub(super) fn new(attributes: PointAttributes, bits: u8, most_intensity: u16) -> Self {
        let most = match attributes.colours {
            true => f64::from((1_u32 << bits) - 1),
            false => f64::from(most_intensity.max(1)),
        };
        Self {
            table: Parameters::default().luma_table(),
            attributes,
            scale: 255.0 / most,
        }
    }

    fn of(&self, point: &CloudPoint) -> f64 {
        let code = match self.attributes {
            PointAttributes { colours: true, .. } => {
                let parts = point.colour.iter().zip(LUMA);
                parts.map(|(code, part)| f64::from(*code) * part).sum()
            }
            _ => f64::from(point.intensity),
        };
        self.table[(code * self.scale).round().min(255.0) as usize]
    }

    fn mean(&self, points: &[CloudPoint]) -> f64 {
        let sum: f64 = points.iter().map(|it| self.of(it)).sum();
        sum / points.len().max(1) as f64
    }
}

/// What is added to the points of a stretch of the curve that were shown one a cell of depth
/// `coarse`, by showing one a cell of depth `fine`; a cube has `bits` at depth 0.
pub(super) fn signature_of(
    points: &[CloudPoint],
    [coarse, fine]: [u32; 2],
    bits: u32,
    light: &Light,
) -> Signature {
    let mut start = 0;
    let mut cells: Vec<Cell> = Vec::new();
    for end in cell_ends(points, coarse, bits) {
        let first = std::mem::replace(&mut start, end);
        let all = &points[first..end];
        let middle = &all[all.len() / 2];
        let is_near = |it: &&CloudPoint| common_depth(it, middle, bits) >= fine;
        let near: Vec<CloudPoint> = all.iter().filter(is_near).copied().collect();
        cells.push(Cell {
            first,
            before: light.mean(all),
            after: light.mean(&near),
        });
    }
    let mut bands = [BandContrast::default(); SIGNATURE_BANDS];
    let mut depth = coarse;
    for band in &mut bands {
        let Some(coarser) = depth.checked_sub(1) else {
            break;
        };
        let means = merged(&cells, points, coarser, bits);
        *band = contrasts(&cells, &means);
        (cells, depth) = (means, coarser);
    }
    Signature { bands }
}

/// Mean luminance of a cell before and after a step; where on the curve it begins.
struct Cell {
    first: usize,
    before: f64,
    after: f64,
}

/// The means of the cells that lie in each larger cell.
fn merged(cells: &[Cell], points: &[CloudPoint], depth: u32, bits: u32) -> Vec<Cell> {
    let mut means: Vec<Cell> = Vec::new();
    let mut count = 0.0;
    for cell in cells {
        let same = means
            .last_mut()
            .filter(|mean| common_depth(&points[mean.first], &points[cell.first], bits) >= depth);
        match same {
            Some(mean) => {
                count += 1.0;
                mean.before += (cell.before - mean.before) / count;
                mean.after += (cell.after - mean.after) / count;
            }
            None => {
                count = 1.0;
                means.push(Cell { ..*cell });
            }
        }
    }
    means
}

/// Contrasts of cells to the larger ones that they lie in, of which there is one for each stretch.
fn contrasts(cells: &[Cell], means: &[Cell]) -> BandContrast {
    let mut band = BandContrast::default();
    let mut mean = means.iter().peekable();
    let mut here = None;
    for cell in cells {
        if let Some(next) = mean.next_if(|it| it.first <= cell.first) {
            here = Some(next);
        }
        let Some(mean) = here else { continue };
        let before = cell.before / mean.before - 1.0;
        let after = cell.after / mean.after - 1.0;
        band.before += before.abs();
        band.after += after.abs();
        band.difference += (after - before).abs();
        band.norm += (after - before).powi(4);
    }
    let count = cells.len().max(1) as f64;
    BandContrast {
        before: band.before / count,
        after: band.after / count,
        difference: band.difference / count,
        norm: (band.norm / count).sqrt().sqrt(),
    }
}
