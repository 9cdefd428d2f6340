//! How does a session log record what was measured?
//!
//! As footprints. What a unit is worth stands there in the place of the area, as the bits of a
//! number of 32 bits, and the angles are 0.

use crate::content::policy::{ImportanceSource, PolicyConfig};
use crate::perception::footprints::{Footprint, Footprints, Measured};

/// What a log records of what was measured.
pub(super) fn recorded(measured: &Measured) -> Footprints {
    match measured {
        Measured::Footprints(footprints) => footprints.clone(),
        Measured::Worths(worths) => {
            let row = |(unit, worth): &(_, f32)| Footprint {
                unit: *unit,
                area: worth.to_bits(),
                ..Footprint::default()
            };
            Footprints::new(worths.iter().map(row).collect())
        }
    }
}

/// What was measured under a policy, by what its log records.
pub(super) fn measured(recorded: &Footprints, policy: &PolicyConfig) -> Measured {
    match policy.importance {
        ImportanceSource::Signatures => Measured::Footprints(recorded.clone()),
        ImportanceSource::Rendered => {
            let worth = |it: &Footprint| (it.unit, f32::from_bits(it.area));
            Measured::Worths(recorded.list().iter().map(worth).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::policy::Policy;

    #[test]
    fn worths_are_read_from_a_log_as_they_were_written() {
        let worths = Measured::worths(&[0.0, 1.5, 0.0, 1e-9]);
        let rows = recorded(&worths);
        let numbers = rows.since(&Footprints::default());
        let bits = [1.5_f32, 1e-9].map(f32::to_bits);
        assert_eq!(numbers, [1, bits[0], 0, 0, 2, bits[1], 0, 0]);
        let policy = PolicyConfig {
            importance: ImportanceSource::Rendered,
            ..PolicyConfig::new(Policy::Perceptual)
        };
        assert_eq!(measured(&rows, &policy), worths);
    }
}
