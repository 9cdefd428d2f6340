//! How much contrast does a tile show that its next coarser level does not?
//!
//! Measured once, while preparing, so that a step can be valued for any gaze without drawing it.

use crate::perception::gain::BandStep;
use crate::perception::measures::contrast::{SIGNATURE_BANDS, Signature};
use crate::perception::measures::pyramid::{band_frequency, doubled, halved};
use crate::perception::measures::step_contrast::StepContrast;
use crate::perception::parameters::Parameters;
use crate::units::Ppd;
use crate::view::picture::{Colour, Picture};

/// The signature of a tile's picture, against the same picture `ratio` times coarser and enlarged
/// again. Luminance is that of the default display. Costs one pass over the picture.
///
/// # Panics
/// When `ratio` is not a power of two.
#[must_use]
pub fn signature_of(picture: &Picture, colour: Colour, ratio: u32) -> Signature {
    assert!(ratio.is_power_of_two(), "a ratio of {ratio} between levels");
    let parameters = Parameters::default();
    let table = luminance_table(&parameters, colour);
    let size = [picture.width, picture.height];
    let codes = picture.planes[0].iter();
    let after: Vec<f64> = codes.map(|code| table[usize::from(*code)]).collect();
    let before = blurred(&after, size, ratio.trailing_zeros());
    let counts = vec![true; after.len()];
    let mut contrast = StepContrast::default();
    contrast.add([before, after], counts, size);
    contrast.signature()
}

/// What a signature says of a step to a level that has `ppd` pixels a degree where it is seen.
#[must_use]
pub fn band_steps(signature: &Signature, ppd: Ppd) -> [BandStep; SIGNATURE_BANDS] {
    core::array::from_fn(|index| {
        let band = signature.bands[index];
        BandStep {
            cpd: band_frequency(index, ppd),
            contrast_before: band.before,
            contrast_after: band.after,
            difference: band.difference,
        }
    })
}

/// Luminance in cd/m² of every code value of the Y plane.
fn luminance_table(parameters: &Parameters, colour: Colour) -> [f64; 256] {
    let full = parameters.luma_table();
    if colour.full_range {
        return full;
    }
    core::array::from_fn(|code| {
        let stretched = (code as f64 - 16.0) * 255.0 / 219.0;
        full[stretched.round().clamp(0.0, 255.0) as usize]
    })
}

/// The picture halved `times` and enlarged to its size again.
fn blurred(fine: &[f64], size: [u32; 2], times: u32) -> Vec<f64> {
    if times == 0 {
        return fine.to_vec();
    }
    let (coarse, coarse_size) = halved(fine, size);
    doubled(&blurred(&coarse, coarse_size, times - 1), coarse_size, size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::perception::measures::contrast::BandContrast;
    use crate::perception::measures::pyramid::Pyramid;
    use crate::view::picture::Matrix;

    const COLOUR: Colour = Colour {
        matrix: Matrix::Bt709,
        full_range: true,
        chroma_left: false,
    };

    /// Vertical stripes of a period in pixels round mid-grey.
    fn stripes(period: f64, amplitude: f64) -> Picture {
        let mut picture = Picture::filled(128, 128, [128; 3]);
        for (k, sample) in picture.planes[0].iter_mut().enumerate() {
            let phase = core::f64::consts::TAU * ((k % 128) as f64 + 0.5) / period;
            *sample = (128.0 + amplitude * phase.cos()).round() as u8;
        }
        picture
    }

    fn differences(picture: &Picture) -> [f64; SIGNATURE_BANDS] {
        signature_of(picture, COLOUR, 2)
            .bands
            .map(|band| band.difference)
    }

    /// The definition: means over two whole pyramids.
    #[test]
    fn a_signature_is_the_mean_difference_of_two_pyramids() {
        for (size, ratio) in [([64, 48], 2u32), ([37, 53], 4), ([9, 5], 2), ([3, 8], 2)] {
            let mut picture = Picture::filled(size[0], size[1], [0, 128, 128]);
            for (k, sample) in (0u32..).zip(&mut picture.planes[0]) {
                *sample = (k.wrapping_mul(2_654_435_761) >> 24) as u8;
            }
            let table = luminance_table(&Parameters::default(), COLOUR);
            let after: Vec<f64> = picture.planes[0]
                .iter()
                .map(|c| table[usize::from(*c)])
                .collect();
            let before = blurred(&after, size, ratio.ilog2());
            let [before, after] = [before, after].map(|values| Pyramid::of(values, size).bands);
            let signature = signature_of(&picture, COLOUR, ratio);
            for (k, band) in signature.bands.iter().enumerate() {
                let (Some(before), Some(after)) = (before.get(k), after.get(k)) else {
                    assert_eq!(*band, BandContrast::default());
                    continue;
                };
                let mean = |at: &dyn Fn(usize) -> f64| {
                    let count = after.contrast.len();
                    (0..count).map(|k| at(k).abs()).sum::<f64>() / count as f64
                };
                let expected = [
                    mean(&|k| before.contrast[k]),
                    mean(&|k| after.contrast[k]),
                    mean(&|k| after.contrast[k] - before.contrast[k]),
                ];
                let found = [band.before, band.after, band.difference];
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!(
                        (found - expected).abs() < 1e-12,
                        "{size:?} {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_plain_tile_gains_nothing() {
        for size in [[128, 128], [1, 1], [7, 30]] {
            let plain = Picture::filled(size[0], size[1], [200, 128, 128]);
            let signature = signature_of(&plain, COLOUR, 2);
            assert!(signature.bands.iter().all(|band| band.difference < 1e-9));
        }
    }

    #[test]
    fn what_the_coarser_level_cannot_hold_is_gained() {
        let fine = differences(&stripes(3.0, 60.0));
        let coarse = differences(&stripes(16.0, 60.0));
        assert!(
            fine[0] > 0.1 && coarse[0] < 0.1 * fine[0],
            "{fine:?} {coarse:?}"
        );
    }

    #[test]
    fn stronger_detail_gains_more() {
        let [weak, strong] = [10.0, 60.0].map(|amplitude| differences(&stripes(3.0, amplitude)));
        assert!(strong[0] > 3.0 * weak[0]);
    }

    #[test]
    fn limited_range_means_the_same_light() {
        let limited = luminance_table(
            &Parameters::default(),
            Colour {
                full_range: false,
                ..COLOUR
            },
        );
        let full = luminance_table(&Parameters::default(), COLOUR);
        assert_eq!(
            [limited[16], limited[235], limited[255]],
            [full[0], full[255], full[255]]
        );
    }
}
