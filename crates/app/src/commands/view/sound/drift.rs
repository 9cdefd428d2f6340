//! How far was the picture from the sound?

use foveal_core::units::Seconds;

/// Milliseconds that are distinguished; more count as the most.
const MOST_MS: usize = 2000;

/// Distances of frames on screen from what was heard then.
#[derive(Clone, Debug)]
pub(crate) struct Drift {
    /// How many were so many whole milliseconds off.
    counts: Vec<u64>,
    /// The last one; positive where the picture was behind.
    last: Option<Seconds>,
    worst: f64,
}

impl Drift {
    /// Of no frame yet.
    pub(crate) fn new() -> Self {
        Self {
            counts: vec![0; MOST_MS + 1],
            last: None,
            worst: 0.0,
        }
    }

    /// How far a frame that is shown from `begin` to `end` is from what is heard: 0 within it,
    /// positive after it.
    pub(crate) fn of_frame(heard: Seconds, [begin, end]: [Seconds; 2]) -> Seconds {
        Seconds((heard.0 - end.0).max(0.0) + (heard.0 - begin.0).min(0.0))
    }

    /// Notes what was measured; it counts once sound and picture had time to come together.
    pub(crate) fn note(&mut self, behind: Option<Seconds>, counts: bool) {
        self.last = behind;
        let Some(off) = behind.filter(|_| counts).map(|behind| behind.0.abs()) else {
            return;
        };
        self.worst = self.worst.max(off);
        self.counts[((off * 1e3) as usize).min(MOST_MS)] += 1;
    }

    /// The last one.
    pub(crate) fn last(&self) -> Option<Seconds> {
        self.last
    }

    /// The greatest and the 95th percentile, rounded up to whole milliseconds; `None` where
    /// nothing was measured.
    pub(crate) fn worst_and_p95_ms(&self) -> Option<[f64; 2]> {
        let all: u64 = self.counts.iter().sum();
        let mut below = 0;
        let at = self.counts.iter().position(|count| {
            below += count;
            all > 0 && below * 100 >= all * 95
        });
        at.map(|ms| [self.worst * 1e3, (ms + 1) as f64])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn within_its_time_a_frame_is_in_step() {
        let of = |heard| Drift::of_frame(Seconds(heard), [Seconds(1.0), Seconds(1.04)]).0;
        assert_eq!((of(1.0), of(1.04)), (0.0, 0.0));
        assert!((of(0.97) + 0.03).abs() < 1e-12 && (of(1.1) - 0.06).abs() < 1e-12);
    }

    #[test]
    fn one_frame_in_twenty_may_be_farther_than_the_ninety_fifth_percentile() {
        let mut drift = Drift::new();
        assert_eq!(drift.worst_and_p95_ms(), None);
        drift.note(Some(Seconds(9.0)), false);
        (0..95).for_each(|_| drift.note(Some(Seconds(-0.0105)), true));
        (0..5).for_each(|_| drift.note(Some(Seconds(5.0)), true));
        assert_eq!(drift.worst_and_p95_ms(), Some([5000.0, 11.0]));
        assert_eq!(drift.last(), Some(Seconds(5.0)));
    }
}
