//! How strongly is contrast seen, asked often?
//!
//! Eccentricity only stretches frequency (the pattern that the model takes has a fixed number of
//! cycles), so sensitivity off the fovea is foveal sensitivity at `frequency / magnification`: one
//! table over octaves of frequency serves every place.

use super::eye::Seen;
use super::parameters::{EyeState, Model, Parameters};
use super::sensitivity::cortical_magnification;
use crate::units::{Cpd, Radians};

/// Octaves of cycles per degree that the table begins at and spans.
const FIRST_OCTAVE: i32 = -6;
const OCTAVES: usize = 15;
/// Entries per octave: interpolation then errs by less than 3e-4 of what can be seen.
const PER_OCTAVE: usize = 128;

/// Rows of eccentricity of a measured table, less one; closer together near the gaze.
const ROWS: usize = 128;
/// Entries of a row.
const ENTRIES: usize = OCTAVES * PER_OCTAVE + 1;

/// Sustained and transient sensitivity over octaves of frequency, for one luminance and one state
/// of the eye; interpolated linearly, constant beyond its ends. Of a measured sensitivity, which
/// eccentricity need not stretch, there is a row for every eccentricity.
#[derive(Clone, Debug, PartialEq)]
pub struct SensitivityTable {
    /// Row by row.
    entries: Vec<[f32; 2]>,
}

impl SensitivityTable {
    /// The table of an eye adapted to `parameters.luminance`. For a steady or landed eye it is
    /// foveal and knows no limit of acuity (both depend on the place); for a jumping one it is
    /// whole: [`Parameters::seen_from_anywhere`]. Costs some milliseconds.
    #[must_use]
    pub fn new(parameters: &Parameters, state: EyeState) -> Self {
        let is_measured = parameters.sensitivity.is_some() && state != EyeState::Jumping;
        let rows = if is_measured { ROWS + 1 } else { 1 };
        let entry = |index: usize| {
            let (row, index) = (index / ENTRIES, index % ENTRIES);
            let octave = index as f64 / PER_OCTAVE as f64 + f64::from(FIRST_OCTAVE);
            let frequency = Cpd(libm::exp2(octave));
            let luminance = parameters.luminance;
            let Seen {
                sustained,
                transient,
            } = match state {
                EyeState::Jumping => parameters.seen_from_anywhere(frequency, luminance),
                _ => parameters.sensitivity(frequency, eccentricity_of(row), luminance),
            };
            [sustained as f32, transient as f32]
        };
        Self {
            entries: (0..rows * ENTRIES).map(entry).collect(),
        }
    }

    /// Sustained and transient sensitivity at `octaves`, log2 of the frequency at the cortex in
    /// cycles per degree, and at an eccentricity in radians, which counts only where it does not
    /// raise frequency ([`Parameters::octaves_raised`]).
    #[must_use]
    pub fn at(&self, octaves: f32, eccentricity: f32) -> [f32; 2] {
        let (row, down) = Self::row(self.entries.len() / ENTRIES, eccentricity);
        let near = self.in_row(row, octaves);
        if down == 0.0 {
            return near;
        }
        let far = self.in_row(row + 1, octaves);
        [0, 1].map(|k| near[k] + (far[k] - near[k]) * down)
    }

    fn in_row(&self, row: usize, octaves: f32) -> [f32; 2] {
        let last = (ENTRIES - 1) as f32;
        let place = ((octaves - FIRST_OCTAVE as f32) * PER_OCTAVE as f32).clamp(0.0, last);
        let index = (place as usize).min(ENTRIES - 2);
        let share = place - index as f32;
        let row = &self.entries[row * ENTRIES..][..ENTRIES];
        let ([a, b], [c, d]) = (row[index], row[index + 1]);
        [a + (c - a) * share, b + (d - b) * share]
    }

    /// Of so many rows that before an eccentricity in radians, and how far that is on the way to
    /// the next.
    #[must_use]
    pub(super) fn row(rows: usize, eccentricity: f32) -> (usize, f32) {
        let last = rows.saturating_sub(1);
        if last == 0 {
            return (0, 0.0);
        }
        let share = eccentricity.max(0.0) / core::f32::consts::PI;
        let place = (share.sqrt() * ROWS as f32).clamp(0.0, last as f32);
        let row = (place as usize).min(last - 1);
        (row, place - row as f32)
    }

    /// The entries, `PER_OCTAVE` for each octave from `FIRST_OCTAVE` (log2 of cycles per degree),
    /// row by row.
    pub(super) fn entries(&self) -> &[[f32; 2]] {
        &self.entries
    }

    /// Those of the fovea, for a copy on a GPU: all there are, but of a measured sensitivity.
    #[must_use]
    pub fn foveal(&self) -> &[[f32; 2]] {
        &self.entries[..ENTRIES]
    }

    /// Entries of a row.
    pub(super) const ENTRIES: usize = ENTRIES;

    /// Log2 of the first entry's frequency.
    pub const FIRST_OCTAVE: i32 = FIRST_OCTAVE;
    /// Entries per octave.
    pub const PER_OCTAVE: usize = PER_OCTAVE;
}

impl Parameters {
    /// By how many octaves a place at `eccentricity` raises frequency at the cortex.
    #[must_use]
    pub fn octaves_raised(&self, eccentricity: Radians) -> f64 {
        match self.model {
            _ if self.sensitivity.is_some() => 0.0,
            Model::Paper => 0.0,
            Model::Default => -libm::log2(cortical_magnification(eccentricity)),
        }
    }
}

/// The eccentricity of a row.
fn eccentricity_of(row: usize) -> Radians {
    let root = row as f64 / ROWS as f64;
    Radians(core::f64::consts::PI * root * root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::perception::measured::sensitivity::MeasuredSensitivity;

    #[test]
    fn a_measured_sensitivity_is_told_at_every_frequency_and_eccentricity() {
        let table = "cpd,ecc_deg,sensitivity\n0.5,0,80\n4,0,120\n32,0,2\n0.5,10,70\n4,10,30\n\
                     32,10,0.5\n0.5,40,20\n4,40,2\n32,40,0.1\n";
        let measured = MeasuredSensitivity::parse(table).unwrap();
        for model in [Model::Paper, Model::Default] {
            let parameters = Parameters {
                sensitivity: Some(measured.clone()),
                ..Parameters::of(model)
            };
            let table = SensitivityTable::new(&parameters, EyeState::Steady);
            for step in 0..400 {
                let frequency = Cpd(libm::exp2(f64::from(step) / 50.0 - 3.1));
                let eccentricity = Radians::from_degrees(f64::from(step % 57) * 0.9);
                assert_eq!(parameters.octaves_raised(eccentricity), 0.0);
                let octaves = libm::log2(frequency.0);
                let found = table.at(octaves as f32, eccentricity.0 as f32);
                let exact = parameters.sensitivity(frequency, eccentricity, parameters.luminance);
                let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 4e-2 * b.max(1.0);
                assert!(
                    near(found[0], exact.sustained),
                    "{model:?} {frequency:?} {eccentricity:?}: {} for {}",
                    found[0],
                    exact.sustained
                );
                assert!(
                    near(found[1], exact.transient),
                    "{model:?} {frequency:?} {eccentricity:?}"
                );
            }
        }
    }

    #[test]
    fn the_table_says_what_the_formula_says() {
        for model in [Model::Paper, Model::Default] {
            let parameters = Parameters::of(model);
            let table = SensitivityTable::new(&parameters, EyeState::Steady);
            let far = SensitivityTable::new(&parameters, EyeState::Jumping);
            for step in 0..400 {
                let frequency = Cpd(libm::exp2(f64::from(step) / 50.0 - 3.0));
                let eccentricity = Radians::from_degrees(f64::from(step % 37));
                let octaves = libm::log2(frequency.0) + parameters.octaves_raised(eccentricity);
                let found = table.at(octaves as f32, eccentricity.0 as f32);
                let exact = parameters.sensitivity(frequency, eccentricity, parameters.luminance);
                // What needs a contrast above 1 to be seen is never seen.
                let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 3e-4 * b.max(1.0);
                assert!(near(found[0], exact.sustained), "{model:?} {frequency:?}");
                assert!(near(found[1], exact.transient), "{model:?} {frequency:?}");
                let anywhere = far.at(libm::log2(frequency.0) as f32, eccentricity.0 as f32);
                let exact = parameters.seen_from_anywhere(frequency, parameters.luminance);
                let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 3e-3 * b.max(1.0);
                assert!(
                    near(anywhere[0], exact.sustained),
                    "{model:?} {frequency:?}"
                );
                assert!(
                    near(anywhere[1], exact.transient),
                    "{model:?} {frequency:?}"
                );
            }
        }
    }
}
