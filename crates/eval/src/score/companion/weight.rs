//! How much does an error count where few cells of the eye look?
//!
//! By the area that the cut-off frequency of Geisler and Perry 1998, *A real-time foveated
//! multiresolution system for low-bandwidth video communication*, resolves there: neither
//! contrast nor luminance nor motion comes in.

use super::errors::pixel_error;
use crate::score::geometry::{Geometry, Tangents};
use crate::score::picture::ScorePicture;

/// Least contrast that is seen at all.
const LEAST_CONTRAST: f64 = 1.0 / 64.0;
/// How fast it rises with frequency, degrees.
const DECAY: f64 = 0.106;
/// Eccentricity at which half the frequency is seen, degrees.
const HALF_DEG: f64 = 2.3;
/// Pixels on a side of the blocks that have one weight.
const BLOCK: u32 = 8;

/// Highest frequency that is seen, cycles per degree.
pub(super) fn cut_off(eccentricity_deg: f64) -> f64 {
    HALF_DEG * (1.0 / LEAST_CONTRAST).ln() / (DECAY * (eccentricity_deg + HALF_DEG))
}

/// Weighed sum of squares over all samples, and the sum of weights.
pub(super) fn weighted_error(
    reference: &ScorePicture,
    test: &ScorePicture,
    geometry: &Geometry,
    ppd: f64,
    gaze: Tangents,
) -> [f64; 2] {
    let [w, h] = reference.size();
    let [blocks_across, blocks_down] = [w, h].map(|side| side.div_ceil(BLOCK));
    let most = ppd / 2.0;
    let mut sums = [0.0; 2];
    for block in 0..blocks_across * blocks_down {
        let [left, top] = [block % blocks_across * BLOCK, block / blocks_across * BLOCK];
        let middle = |axis: usize, first: u32, length: u32| {
            let last = (first + BLOCK).min(length) - 1;
            let index = (first + last) as usize / 2;
            geometry.tangent(axis, index, length as usize)
        };
        let place = [middle(0, left, w), middle(1, top, h)];
        let resolved = cut_off(geometry.eccentricity_deg(place, gaze)).min(most) / most;
        let weight = resolved * resolved;
        for y in top..(top + BLOCK).min(h) {
            for x in left..(left + BLOCK).min(w) {
                sums[0] += weight * pixel_error(reference, test, (y * w + x) as usize);
                sums[1] += weight * 3.0;
            }
        }
    }
    sums
}
