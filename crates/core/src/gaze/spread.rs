//! How far may the eyes be from where they are said to look?
//!
//! A spread is one standard deviation along any axis. It grows with the time between the newest
//! evidence and the moment the picture is seen: a delay and a loss of the signal are the same to
//! it.

use super::head_prediction::saturating::FREE_VIEWING_SPREAD_DEG;
use crate::gaze::table::between;
use crate::units::{Radians, Seconds};

/// Who says where the eyes look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GazeEvidence {
    /// A pointer that stands for the gaze. It stays where it was put.
    Mouse,
    /// The last sample of a tracker.
    Tracker,
    /// The head alone.
    Head,
    /// A tracker's last sample and the head, blended by age.
    Blend,
}

/// Spread that eyes add to a last gaze by its age, in seconds and degrees: root mean square angle
/// over the square root of two, measured on eight recordings of Hu et al. 2019.
const LAST_DEG: [(f64, f64); 11] = [
    (0.0, 0.0),
    (0.025, 3.16),
    (0.05, 4.60),
    (0.1, 5.87),
    (0.15, 6.66),
    (0.2, 7.21),
    (0.3, 8.00),
    (0.5, 9.13),
    (0.75, 10.03),
    (1.0, 10.64),
    (2.0, 11.72),
];
/// The same for the blend of last gaze and head.
const BLEND_DEG: [(f64, f64); 11] = [
    (0.0, 0.0),
    (0.025, 3.16),
    (0.05, 4.60),
    (0.1, 5.63),
    (0.15, 6.19),
    (0.2, 6.52),
    (0.3, 7.03),
    (0.5, 7.80),
    (0.75, 8.50),
    (1.0, 9.00),
    (2.0, 9.78),
];
/// The same for the head alone: the part that age adds to what is there without delay.
const HEAD_DEG: [(f64, f64); 8] = [
    (0.0, 0.0),
    (0.1, 1.89),
    (0.2, 2.94),
    (0.3, 3.73),
    (0.5, 4.83),
    (0.75, 5.80),
    (1.0, 6.50),
    (2.0, 7.53),
];

impl GazeEvidence {
    /// Spread without delay: a pointer's, a tracker's accuracy (1.1° mean on a common headset,
    /// Schuetz and Fiehler 2022, with its precision), or that of the head's free-viewing preset.
    #[must_use]
    pub fn own_spread(self) -> Radians {
        Radians::from_degrees(match self {
            Self::Mouse => 0.5,
            Self::Tracker | Self::Blend => 1.5,
            Self::Head => FREE_VIEWING_SPREAD_DEG,
        })
    }

    /// The spread of a direction whose source has `own` spread, `age` after its newest evidence.
    /// An age below 0 counts as 0; beyond two seconds nothing grows further.
    #[must_use]
    pub fn spread(self, own: Radians, age: Seconds) -> Radians {
        let added = Radians::from_degrees(match self {
            Self::Mouse => 0.0,
            Self::Tracker => between(&LAST_DEG, age.0),
            Self::Head => between(&HEAD_DEG, age.0),
            Self::Blend => between(&BLEND_DEG, age.0),
        });
        Radians((own.0 * own.0 + added.0 * added.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [GazeEvidence; 4] = [
        GazeEvidence::Mouse,
        GazeEvidence::Tracker,
        GazeEvidence::Head,
        GazeEvidence::Blend,
    ];

    fn degrees(evidence: GazeEvidence, age: f64) -> f64 {
        evidence
            .spread(evidence.own_spread(), Seconds(age))
            .to_degrees()
    }

    #[test]
    fn a_spread_never_shrinks_with_age() {
        for evidence in ALL {
            for k in -5..250 {
                let age = f64::from(k) * 0.01;
                assert!(
                    degrees(evidence, age + 0.01) >= degrees(evidence, age),
                    "{evidence:?}"
                );
            }
        }
    }

    #[test]
    fn without_delay_each_source_has_its_own_spread() {
        let own = ALL.map(|evidence| (degrees(evidence, 0.0) * 10.0).round() / 10.0);
        assert_eq!(own, [0.5, 1.5, 6.2, 1.5]);
    }

    #[test]
    fn a_blend_is_never_less_certain_than_the_late_tracker() {
        for k in 0..250 {
            let age = f64::from(k) * 0.01;
            let [blend, last] =
                [GazeEvidence::Blend, GazeEvidence::Tracker].map(|source| degrees(source, age));
            assert!(blend <= last + 1e-9, "{age}: {blend} {last}");
        }
    }

    #[test]
    fn a_better_tracker_stays_better() {
        let age = Seconds(0.05);
        let [good, poor] =
            [0.5, 4.0].map(|own| GazeEvidence::Tracker.spread(Radians::from_degrees(own), age));
        assert!(good < poor);
    }
}
