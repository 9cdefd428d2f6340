//! How much contrast does a refinement add, in twelve bytes?
//!
//! For every unit that refines, what its pictures show that the next coarser level does not, as
//! both are decoded. With it a step can be valued for any gaze without decoding anything.
//! `docs/formats/pack.md` is normative.

use std::sync::LazyLock;

/// Octaves of spatial frequency that a signature measures: the one that the step adds, and those
/// below it that it changes.
pub const SIGNATURE_BANDS: usize = 3;

/// Mean contrast of one octave over a tile, as seen before and after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BandContrast {
    /// Mean absolute contrast at the coarser level.
    pub before: f64,
    /// Mean absolute contrast at this level.
    pub after: f64,
    /// Mean absolute difference of the two, place by place.
    pub difference: f64,
    /// Fourth root of the mean fourth power of that difference: what is seen of it, since an eye
    /// sees a few strong edges where the mean is of flat surroundings.
    pub norm: f64,
}

/// Norm over mean of differences where version 1 does not say: that of differences whose sizes
/// fall off exponentially, 24^(1/4).
const USUAL_NORM: f64 = 2.213;

/// What one unit adds to the next coarser level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signature {
    /// From the finest octave of this level (a quarter to half a cycle a pixel) downwards.
    pub bands: [BandContrast; SIGNATURE_BANDS],
}

/// Largest contrast that is stored; more is stored as this.
const MOST_CONTRAST: f64 = 4.0;
/// Steps of the logarithmic code for each doubling of contrast: 4.4 % a step.
const STEPS_PER_OCTAVE: f64 = 16.0;

impl Signature {
    /// Bytes of a signature in the table.
    pub const BYTES: usize = 4 * SIGNATURE_BANDS;
    /// Bytes of a signature of version 1.
    pub const BYTES_V1: usize = 3 * SIGNATURE_BANDS;

    /// For each octave, the one of the two whose norm is larger: of several pictures of a unit,
    /// where each octave gains most. What appears late counts as much as if it had been there
    /// from the first picture on.
    #[must_use]
    pub fn strongest(self, other: Self) -> Self {
        let band = |index: usize| {
            let [one, other] = [self.bands[index], other.bands[index]];
            if other.norm > one.norm { other } else { one }
        };
        Self {
            bands: [0, 1, 2].map(band),
        }
    }

    /// The signature as it lies in the table. Contrasts are coded logarithmically: off by at most
    /// 2.2 %, and 0 below 7e-5.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        for (bytes, band) in bytes.chunks_exact_mut(4).zip(&self.bands) {
            let told = [band.before, band.after, band.difference, band.norm];
            bytes.copy_from_slice(&told.map(code_of_contrast));
        }
        bytes
    }

    /// The signature that these bytes encode. Every combination of bytes is one.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let band = |b: usize| {
            let told = [0, 1, 2, 3].map(|k| contrast_of_code(bytes[4 * b + k]));
            let [before, after, difference, norm] = told;
            BandContrast {
                before,
                after,
                difference,
                norm,
            }
        };
        Self {
            bands: [0, 1, 2].map(band),
        }
    }

    /// The signature that these bytes of version 1 encode; norms are guessed from means.
    #[must_use]
    pub fn from_bytes_v1(bytes: [u8; Self::BYTES_V1]) -> Self {
        let band = |b: usize| {
            let [before, after, difference] = [0, 1, 2].map(|k| contrast_of_code(bytes[3 * b + k]));
            BandContrast {
                before,
                after,
                difference,
                norm: USUAL_NORM * difference,
            }
        };
        Self {
            bands: [0, 1, 2].map(band),
        }
    }
}

fn code_of_contrast(contrast: f64) -> u8 {
    if contrast <= 0.0 || contrast.is_nan() {
        return 0;
    }
    let octaves = libm::log2(contrast / MOST_CONTRAST);
    (255.0 + STEPS_PER_OCTAVE * octaves)
        .round()
        .clamp(0.0, 255.0) as u8
}

fn contrast_of_code(code: u8) -> f64 {
    static CONTRASTS: LazyLock<[f64; 256]> = LazyLock::new(|| {
        core::array::from_fn(|code| match code {
            0 => 0.0,
            _ => MOST_CONTRAST * libm::exp2((code as f64 - 255.0) / STEPS_PER_OCTAVE),
        })
    });
    CONTRASTS[usize::from(code)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_contrast_is_told_to_within_a_few_percent(contrast in 1e-4f64..4.0) {
            let told = contrast_of_code(code_of_contrast(contrast));
            prop_assert!((told / contrast - 1.0).abs() < 0.023, "{contrast} stored as {told}");
        }

        #[test]
        fn version_1_tells_the_same_means(bytes in any::<[u8; Signature::BYTES]>()) {
            let old = core::array::from_fn(|k| bytes[k / 3 * 4 + k % 3]);
            let [old, new] = [Signature::from_bytes_v1(old), Signature::from_bytes(bytes)];
            for (old, new) in old.bands.iter().zip(&new.bands) {
                prop_assert_eq!(BandContrast { norm: new.norm, ..*old }, *new);
            }
        }

        #[test]
        fn any_bytes_are_a_signature_and_come_back(bytes in any::<[u8; Signature::BYTES]>()) {
            prop_assert_eq!(Signature::from_bytes(bytes).to_bytes(), bytes);
        }
    }

    #[test]
    fn no_contrast_and_nonsense_are_told_as_none() {
        assert_eq!([0.0, -1.0, f64::NAN, 1e-9].map(code_of_contrast), [0; 4]);
        assert_eq!(code_of_contrast(f64::INFINITY), 255);
    }
}
