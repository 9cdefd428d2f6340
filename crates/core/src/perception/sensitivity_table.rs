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

/// Sustained and transient sensitivity over octaves of frequency, for one luminance and one state
/// of the eye; interpolated linearly, constant beyond its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct SensitivityTable {
    entries: Vec<[f32; 2]>,
}

impl SensitivityTable {
    /// The table of an eye adapted to `parameters.luminance`. For a steady or landed eye it is
    /// foveal and knows no limit of acuity (both depend on the place); for a jumping one it is
    /// whole: [`Parameters::seen_from_anywhere`]. Costs some milliseconds.
    #[must_use]
    pub fn new(parameters: &Parameters, state: EyeState) -> Self {
        let entry = |index: usize| {
            let octave = index as f64 / PER_OCTAVE as f64 + f64::from(FIRST_OCTAVE);
            let frequency = Cpd(libm::exp2(octave));
            let luminance = parameters.luminance;
            let Seen {
                sustained,
                transient,
            } = match state {
                EyeState::Jumping => parameters.seen_from_anywhere(frequency, luminance),
                _ => parameters.sensitivity(frequency, Radians(0.0), luminance),
            };
            [sustained as f32, transient as f32]
        };
        Self {
            entries: (0..=OCTAVES * PER_OCTAVE).map(entry).collect(),
        }
    }

    /// Sustained and transient sensitivity at `octaves`, log2 of the frequency at the cortex in
    /// cycles per degree.
    #[must_use]
    pub fn at(&self, octaves: f32) -> [f32; 2] {
        let last = (OCTAVES * PER_OCTAVE) as f32;
        let place = ((octaves - FIRST_OCTAVE as f32) * PER_OCTAVE as f32).clamp(0.0, last);
        let index = (place as usize).min(OCTAVES * PER_OCTAVE - 1);
        let share = place - index as f32;
        let ([a, b], [c, d]) = (self.entries[index], self.entries[index + 1]);
        [a + (c - a) * share, b + (d - b) * share]
    }

    /// The entries, `per_octave` for each octave from `first_octave` (log2 of cycles per degree):
    /// for a copy on a GPU.
    #[must_use]
    pub fn entries(&self) -> &[[f32; 2]] {
        &self.entries
    }

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
            Model::Paper => 0.0,
            Model::Default => -libm::log2(cortical_magnification(eccentricity)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
                let found = table.at(octaves as f32);
                let exact = parameters.sensitivity(frequency, eccentricity, parameters.luminance);
                // What needs a contrast above 1 to be seen is never seen.
                let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 3e-4 * b.max(1.0);
                assert!(near(found[0], exact.sustained), "{model:?} {frequency:?}");
                assert!(near(found[1], exact.transient), "{model:?} {frequency:?}");
                let anywhere = far.at(libm::log2(frequency.0) as f32);
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
