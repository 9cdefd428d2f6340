//! How much contrast does a tile show that its next coarser level does not?
//!
//! Measured once, while preparing, so that a step can be valued for any gaze without drawing it.

use super::gain::BandStep;
use super::parameters::Parameters;
use super::pyramid::{Band, Pyramid, band_frequency, doubled, halved};
use crate::asset::picture::{Colour, Picture};
use crate::asset::signature::{BandContrast, SIGNATURE_BANDS, Signature};
use crate::units::Ppd;

/// The signature of a tile's picture, against the same picture `ratio` times coarser and enlarged
/// again. Luminance is that of the default display. Costs about 60 ns a pixel.
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
    let [before, after] = [before, after].map(|luminance| Pyramid::of(luminance, size).bands);
    let mut bands = [BandContrast::default(); SIGNATURE_BANDS];
    for (band, (before, after)) in bands.iter_mut().zip(before.iter().zip(&after)) {
        *band = BandContrast {
            before: mean_of(&before.contrast, |k| before.contrast[k]),
            after: mean_of(&after.contrast, |k| after.contrast[k]),
            difference: mean_of(&after.contrast, |k| difference(before, after, k)),
        };
    }
    Signature { bands }
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

fn mean_of(values: &[f64], at: impl Fn(usize) -> f64) -> f64 {
    (0..values.len()).map(|k| at(k).abs()).sum::<f64>() / values.len().max(1) as f64
}

fn difference(before: &Band, after: &Band, k: usize) -> f64 {
    after.contrast[k] - before.contrast[k]
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
    use crate::asset::picture::Matrix;

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
