//! How much worse than the finest picture does a coarser one look, before anybody judged it?
//!
//! The difference and the pooling of FovVideoVDP (Mantiuk et al. 2021, version 1.2), on mean
//! contrasts of octaves in the place of pixels: what levels are chosen for is what they are judged
//! by. The judge takes its constants from here.

use super::sensitivity_table::SensitivityTable;
use crate::units::Radians;

/// Exponent of contrast in the difference (`mask_p`).
pub const DIFFERENCE_EXPONENT: f64 = 2.4;
/// Strength of masking: `10^mask_c` with `mask_c` = -0.973838.
pub const MASKING: f64 = 0.106_209_166;
/// Exponents of masking: sustained, transient (`mask_q`).
pub const MASKING_EXPONENTS: [f64; 2] = [2.436_85, 4.946];
/// Exponent of pooling over pixels (`beta`).
pub const SPACE_EXPONENT: f64 = 1.521_34;
/// JOD lost at a quality difference of 1 (`jod_a`).
pub const JOD_SCALE: f64 = 0.016_171_3;
/// Exponent from quality difference to JOD: `10^log_jod_exp` with `log_jod_exp` = -0.2280.
pub const JOD_EXPONENT: f64 = 0.591_561_634;
/// The score of no difference.
pub const BEST_JOD: f64 = 10.0;

/// JOD lost at a quality difference, which counts as 0 below 0.
#[must_use]
pub fn jod_lost(quality: f64) -> f64 {
    JOD_SCALE * libm::pow(quality.max(0.0), JOD_EXPONENT)
}

/// The quality difference at which a score is reached: the inverse of [`jod_lost`]; 0 from 10 on.
#[must_use]
pub fn quality_of_jod(jod: f64) -> f64 {
    libm::pow((BEST_JOD - jod).max(0.0) / JOD_SCALE, 1.0 / JOD_EXPONENT)
}

/// What the eye misses of one octave: powers of contrast, so that sensitivity is multiplied in
/// later.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LostOctave {
    lost: f64,
    masking: f64,
}

impl LostOctave {
    /// An octave of which contrast `lost` is shown wrongly and `kept` is shown; both are means of
    /// absolute values.
    #[must_use]
    pub fn new(lost: f64, kept: f64) -> Self {
        Self {
            lost: libm::pow(lost, DIFFERENCE_EXPONENT),
            masking: libm::pow(MASKING * kept, MASKING_EXPONENTS[0]),
        }
    }
}

/// Sensitivity to one octave, raised to the powers that a [`LostOctave`] is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensed {
    difference: f64,
    masking: f64,
}

/// [`Sensed`] over octaves of frequency: powers of a [`SensitivityTable`], made once.
#[derive(Clone, Debug, PartialEq)]
pub struct SensedTable {
    /// Row by row of eccentricity.
    entries: Vec<Sensed>,
}

impl SensedTable {
    /// Of the sustained sensitivity of a table.
    #[must_use]
    pub fn new(table: &SensitivityTable) -> Self {
        let sensed = |entry: &[f32; 2]| Sensed::of(f64::from(entry[0]));
        Self {
            entries: table.entries().iter().map(sensed).collect(),
        }
    }

    /// Sensitivities at an eccentricity, as [`SensitivityTable::at`] takes it.
    #[must_use]
    pub fn row(&self, eccentricity: Radians) -> SensedRow<'_> {
        let rows = self.entries.len() / SensitivityTable::ENTRIES;
        let (row, down) = SensitivityTable::row(rows, eccentricity.0 as f32);
        SensedRow {
            table: self,
            row,
            down: f64::from(down),
        }
    }

    fn in_row(&self, row: usize, octaves: f64) -> Sensed {
        let first = f64::from(SensitivityTable::FIRST_OCTAVE);
        let entries = &self.entries[row * SensitivityTable::ENTRIES..][..SensitivityTable::ENTRIES];
        let last = entries.len() - 1;
        let place = (octaves - first) * SensitivityTable::PER_OCTAVE as f64;
        let place = place.clamp(0.0, last as f64);
        let index = (place as usize).min(last - 1);
        entries[index].towards(&entries[index + 1], place - index as f64)
    }
}

/// A [`SensedTable`] at one eccentricity.
#[derive(Clone, Copy, Debug)]
pub struct SensedRow<'a> {
    table: &'a SensedTable,
    row: usize,
    down: f64,
}

impl SensedRow<'_> {
    /// At `octaves` (log2 of the frequency at the cortex in cycles per degree), where the display
    /// shows all of it. Interpolated linearly, constant beyond the ends.
    #[must_use]
    pub fn at(&self, octaves: f64) -> Sensed {
        let near = self.table.in_row(self.row, octaves);
        match self.down > 0.0 {
            true => near.towards(&self.table.in_row(self.row + 1, octaves), self.down),
            false => near,
        }
    }
}

impl Sensed {
    /// Of a sensitivity, or of a share of one.
    #[must_use]
    pub fn of(sensitivity: f64) -> Self {
        Self {
            difference: libm::pow(sensitivity, DIFFERENCE_EXPONENT),
            masking: libm::pow(sensitivity, MASKING_EXPONENTS[0]),
        }
    }

    /// This sensitivity, as far as the display shows the octave.
    #[must_use]
    pub fn times(&self, share: &Self) -> Self {
        Self {
            difference: self.difference * share.difference,
            masking: self.masking * share.masking,
        }
    }

    /// Whether nothing of the octave is seen.
    #[must_use]
    pub fn is_blind(&self) -> bool {
        self.difference == 0.0
    }

    fn towards(self, other: &Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + (b - a) * share;
        Self {
            difference: between(self.difference, other.difference),
            masking: between(self.masking, other.masking),
        }
    }

    /// The difference that this eye sees in an octave: Mantiuk et al. 2021, sustained channel.
    #[must_use]
    pub fn difference(&self, octave: &LostOctave) -> f64 {
        self.difference * octave.lost / (1.0 + self.masking * octave.masking)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::perception::parameters::{EyeState, Parameters};

    #[test]
    fn a_score_and_its_quality_difference_are_one_anothers_inverse() {
        for jod in [5.0, 8.25, 9.0, 9.5, 9.75, 9.99] {
            let back = BEST_JOD - jod_lost(quality_of_jod(jod));
            assert!((back - jod).abs() < 1e-9, "{jod} {back}");
        }
        assert_eq!(quality_of_jod(10.0), 0.0);
        assert_eq!(jod_lost(-1.0), 0.0);
    }

    #[test]
    fn more_lost_is_seen_more_and_more_kept_hides_it() {
        let table = SensitivityTable::new(&Parameters::default(), EyeState::Steady);
        let table = SensedTable::new(&table);
        let ahead = Radians(0.0);
        let sensed = table.row(ahead).at(2.0);
        let seen = |lost, kept| sensed.difference(&LostOctave::new(lost, kept));
        assert!(seen(0.2, 0.0) > seen(0.1, 0.0));
        assert!(seen(0.1, 0.2) < seen(0.1, 0.0));
        assert_eq!(seen(0.0, 0.3), 0.0);
        let unseen = sensed.times(&Sensed::of(0.0));
        assert_eq!(unseen.difference(&LostOctave::new(1.0, 0.0)), 0.0);
    }
}
