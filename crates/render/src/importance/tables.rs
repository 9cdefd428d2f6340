//! Which tables of the eye do the passes look up?
//!
//! Filled by core, so that no formula of the eye is written in WGSL.

use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::perception::sensitivity_table::SensitivityTable;
use foveal_core::perception::spread::effective_eccentricity;
use foveal_core::units::Radians;
use glam::DVec3;

/// The chord from the gaze at which its table is an octave in: half a degree.
pub(crate) const FIRST_CHORD: f64 = 0.5 * core::f64::consts::PI / 180.0;
/// Entries per octave of `FIRST_CHORD + chord`.
pub(crate) const CHORDS_PER_OCTAVE: f64 = 32.0;
/// Entries: the longest chord is 2, not quite eight octaves.
pub(crate) const CHORDS: usize = 8 * 32;

/// The eccentricity at which rows of places are an octave in, in degrees.
const FIRST_DEG: f64 = 0.5;
/// Rows per octave of `FIRST_DEG + eccentricity`.
pub(crate) const ROWS_PER_OCTAVE: f64 = 64.0;
/// Rows: 180° is 8.5 octaves.
const ROWS: usize = 9 * 64;
/// Spacings to either side of the horizontal meridian.
const HALF_COLUMNS: usize = 32;

/// Spacing of a place where acuity limits nothing, in degrees per cycle.
const NO_SPACING: f32 = 1e-9;

/// The tables of one eye.
pub(crate) struct EyeTables {
    /// Sustained and transient sensitivity by octaves of frequency.
    pub(crate) sensitivities: Vec<[f32; 2]>,
    /// Octaves raised and spacings, row by row of eccentricity.
    pub(crate) places: Vec<f32>,
}

impl EyeTables {
    /// The tables of an eye in `state`: a jumping one has the same sensitivity everywhere, which
    /// its table already limits to what is resolved. Costs some hundredths of a second.
    pub(crate) fn new(parameters: &Parameters, state: EyeState) -> Self {
        let row = |row| match state {
            EyeState::Jumping => {
                let mut places = [NO_SPACING; 2 * HALF_COLUMNS + 2];
                places[0] = 0.0;
                places
            }
            _ => place_row(parameters, row),
        };
        Self {
            sensitivities: SensitivityTable::new(parameters, state).foveal().to_vec(),
            places: (0..=ROWS).flat_map(row).collect(),
        }
    }

    /// Highest sustained and highest transient sensitivity.
    pub(crate) fn most_seen(&self) -> [f64; 2] {
        let most = |k: usize| self.sensitivities.iter().map(|s| s[k]).fold(0.0, f32::max);
        [0, 1].map(|k| f64::from(most(k)))
    }
}

/// What is resolved at the eccentricity of a row: by how many octaves frequency is raised, then
/// degrees per cycle from straight below the gaze, past its side, to straight above.
fn place_row(parameters: &Parameters, row: usize) -> [f32; 2 * HALF_COLUMNS + 2] {
    let degrees = FIRST_DEG * ((row as f64 / ROWS_PER_OCTAVE).exp2() - 1.0);
    let eccentricity = Radians::from_degrees(degrees.min(180.0));
    let model = parameters.acuity_model();
    core::array::from_fn(|column| {
        if column == 0 {
            return parameters.octaves_raised(eccentricity) as f32;
        }
        let upward = (column as f64 - 1.0) / HALF_COLUMNS as f64 - 1.0;
        let up = upward.signum() * upward.abs().sqrt();
        let across = DVec3::new((1.0 - up * up).max(0.0).sqrt(), up, 0.0);
        let there = DVec3::NEG_Z * eccentricity.0.cos() + across * eccentricity.0.sin();
        (1.0 / model.acuity(DVec3::NEG_Z, there).0) as f32
    })
}

/// The row of places for every chord from the gaze, its spread taken in. Costs some milliseconds
/// when there is a spread.
pub(crate) fn row_from_chord(onlooker: &Onlooker) -> Vec<f32> {
    let row = |entry: usize| {
        let chord = FIRST_CHORD * ((entry as f64 / CHORDS_PER_OCTAVE).exp2() - 1.0);
        let apart = Radians(2.0 * (chord / 2.0).min(1.0).asin());
        let seen = effective_eccentricity(apart, onlooker.gaze.spread);
        (ROWS_PER_OCTAVE * (1.0 + seen.to_degrees() / FIRST_DEG).log2()) as f32
    };
    (0..=CHORDS).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::perception::parameters::Model;

    #[test]
    fn tables_reach_all_around_the_eye() {
        let last = FIRST_CHORD * ((CHORDS as f64 / CHORDS_PER_OCTAVE).exp2() - 1.0);
        assert!(last >= 2.0, "{last}");
        let last = FIRST_DEG * ((ROWS as f64 / ROWS_PER_OCTAVE).exp2() - 1.0);
        assert!(last >= 180.0, "{last}");
    }

    #[test]
    fn a_row_has_the_acuity_of_the_model_on_its_meridians() {
        for model in [Model::Paper, Model::Default] {
            let parameters = Parameters::of(model);
            let row = place_row(&parameters, 3 * ROWS_PER_OCTAVE as usize);
            let eccentricity = Radians::from_degrees(3.5);
            let gaze = DVec3::NEG_Z;
            for (column, across) in [(1, DVec3::NEG_Y), (33, DVec3::X), (65, DVec3::Y)] {
                let there = gaze * eccentricity.0.cos() + across * eccentricity.0.sin();
                let expected = parameters.acuity_model().acuity(gaze, there).0;
                let found = 1.0 / f64::from(row[column]);
                assert!((found / expected - 1.0).abs() < 1e-6, "{model:?} {column}");
            }
        }
    }
}
