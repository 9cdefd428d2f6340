//! How much contrast does a refinement add, told in nine bytes?
//!
//! The side table `signatures` of a pack: for every unit that refines, what its first picture
//! shows that the next coarser level does not. With it a step can be valued for any gaze without
//! decoding anything. `docs/formats/pack.md` is normative.

use super::pack::{Pack, PackError};
use super::unit::UnitId;
use crate::units::counted;

/// Name of the side table.
pub const SIGNATURES: &str = "signatures";
/// Version of its layout.
pub const SIGNATURES_VERSION: u32 = 1;
/// Octaves of spatial frequency that a signature tells of: the one that the step adds, and those
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
}

/// What one unit adds to the next coarser level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signature {
    /// From the finest octave of this level (a quarter to half a cycle a pixel) downwards.
    pub bands: [BandContrast; SIGNATURE_BANDS],
}

/// Largest contrast that is told; more is told as this.
const MOST_CONTRAST: f64 = 4.0;
/// Steps of the logarithmic code for each doubling of contrast: 4.4 % a step.
const STEPS_PER_OCTAVE: f64 = 16.0;

impl Signature {
    /// Bytes of a signature in the table.
    pub const BYTES: usize = 3 * SIGNATURE_BANDS;

    /// The signature as it lies in the table. Contrasts are coded logarithmically: off by at most
    /// 2.2 %, and 0 below 7e-5.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        for (bytes, band) in bytes.chunks_exact_mut(3).zip(&self.bands) {
            let told = [band.before, band.after, band.difference].map(code_of_contrast);
            bytes.copy_from_slice(&told);
        }
        bytes
    }

    /// The signature that these bytes tell. Every combination of bytes is one.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let band = |b: usize| {
            let [before, after, difference] = [0, 1, 2].map(|k| contrast_of_code(bytes[3 * b + k]));
            BandContrast {
                before,
                after,
                difference,
            }
        };
        Self {
            bands: [0, 1, 2].map(band),
        }
    }
}

/// The signatures of a pack.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signatures {
    rows: Vec<u8>,
    /// The first unit that has one: those of the coarsest level refine nothing.
    first: u32,
}

impl Signatures {
    /// The signatures in `rows`, the bytes of the side table of `pack`. Refuses another version
    /// and another length than a row for every unit finer than the coarsest level.
    pub fn parse(pack: &Pack, version: u32, rows: Vec<u8>) -> Result<Self, PackError> {
        let first = pack.first_refining_unit().0;
        let expected = (pack.units().len() - first as usize) * Signature::BYTES;
        if version != SIGNATURES_VERSION || rows.len() != expected {
            return Err(PackError::new(
                &format!("side table {SIGNATURES}"),
                format!("version {version}, {}", counted(rows.len(), "byte")),
                format!(
                    "version {SIGNATURES_VERSION}, {}",
                    counted(expected, "byte")
                ),
            ));
        }
        Ok(Self { rows, first })
    }

    /// The signature of a unit; `None` for the coarsest level.
    #[must_use]
    pub fn of(&self, unit: UnitId) -> Option<Signature> {
        let row = unit.0.checked_sub(self.first)? as usize;
        let bytes = self.rows.get(row * Signature::BYTES..)?.first_chunk()?;
        Some(Signature::from_bytes(*bytes))
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
    match code {
        0 => 0.0,
        _ => MOST_CONTRAST * libm::exp2((f64::from(code) - 255.0) / STEPS_PER_OCTAVE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_contrast_is_told_to_within_a_few_percent(contrast in 1e-4f64..4.0) {
            let told = contrast_of_code(code_of_contrast(contrast));
            prop_assert!((told / contrast - 1.0).abs() < 0.023, "{contrast} told as {told}");
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
