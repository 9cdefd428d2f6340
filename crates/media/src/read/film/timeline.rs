//! When is each frame shown?

use ffmpeg_next::Rational;

/// A step back by more than this is a new start of the stamps, not one bad stamp; nanoseconds.
const DISCONTINUITY_NS: i128 = 1_000_000_000;
const NS_PER_SECOND: i128 = 1_000_000_000;

/// Turns time stamps into strictly rising times since the first frame.
pub(crate) struct FileTimeline {
    /// Numerator and denominator in seconds.
    tick: [i128; 2],
    frame_ns: i64,
    /// Stamp, in nanoseconds, of time 0.
    origin_ns: Option<i128>,
    last_ns: Option<i64>,
    /// Stamps that did not rise.
    repaired: u64,
}

impl FileTimeline {
    /// `tick` is the unit of the stamps in seconds, `frame_rate` frames a second; neither is
    /// trusted to be positive.
    pub(crate) fn new(tick: Rational, frame_rate: [i32; 2]) -> Self {
        let [frames, seconds] = frame_rate.map(|n| i64::from(n.max(1)));
        let tick = [tick.0, tick.1].map(|number| i128::from(number.max(1)));
        let frame_ns = (seconds * 1_000_000_000 / frames).max(1);
        Self {
            tick,
            frame_ns,
            origin_ns: None,
            last_ns: None,
            repaired: 0,
        }
    }

    /// The same whose stamps count halves of the unit.
    pub(crate) fn of_halves(self) -> Self {
        let [num, den] = self.tick;
        Self {
            tick: [num, 2 * den],
            ..self
        }
    }

    /// How many stamps did not rise and were replaced.
    pub(crate) fn repaired(&self) -> u64 {
        self.repaired
    }

    /// When the next frame is due if it keeps the average frame rate, nanoseconds.
    pub(crate) fn predicted_ns(&self) -> i64 {
        self.last_ns
            .map_or(0, |last| last.saturating_add(self.frame_ns))
    }

    /// The time of the next frame in nanoseconds after the first; a missing stamp, or one that does
    /// not rise, is replaced by one frame after the last.
    pub(crate) fn time_ns(&mut self, stamp: Option<i64>) -> i64 {
        let predicted = self.predicted_ns();
        let stamp_ns = stamp.map(|ticks| self.ns_from_ticks(ticks));
        let time = match (stamp_ns, self.origin_ns) {
            (None, _) => predicted,
            (Some(stamp), None) => {
                self.origin_ns = Some(stamp - i128::from(predicted));
                predicted
            }
            (Some(stamp), Some(origin)) => {
                let last = i128::from(self.last_ns.unwrap_or(-1));
                let time = stamp - origin;
                if last - time > DISCONTINUITY_NS {
                    self.origin_ns = Some(stamp - i128::from(predicted));
                }
                if time > last {
                    i64::try_from(time).unwrap_or(predicted)
                } else {
                    self.repaired += 1;
                    predicted
                }
            }
        };
        self.last_ns = Some(time);
        time
    }

    /// A stamp in nanoseconds, 0 where there is none.
    pub(crate) fn stamp_ns(&self, stamp: Option<i64>) -> i64 {
        let ns = stamp.map_or(0, |ticks| self.ns_from_ticks(ticks));
        i64::try_from(ns).unwrap_or(0)
    }

    fn ns_from_ticks(&self, ticks: i64) -> i128 {
        let [num, den] = self.tick;
        (i128::from(ticks) * num * NS_PER_SECOND).div_euclid(den)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MS: i64 = 1_000_000;

    fn times(stamps: &[Option<i64>]) -> Vec<i64> {
        let mut timeline = FileTimeline::new(Rational(1, 1000), [25, 1]);
        stamps
            .iter()
            .map(|&stamp| timeline.time_ns(stamp))
            .collect()
    }

    #[test]
    fn uneven_stamps_are_kept() {
        assert_eq!(
            times(&[Some(500), Some(510), Some(600)]),
            [0, 10 * MS, 100 * MS]
        );
    }

    #[test]
    fn a_missing_or_repeated_stamp_is_repaired_from_the_frame_rate() {
        let kept = [0, 40 * MS, 80 * MS, 120 * MS];
        assert_eq!(times(&[Some(7), None, Some(87), Some(127)]), kept);
        assert_eq!(times(&[Some(7), Some(47), Some(47), Some(127)]), kept);
        assert_eq!(times(&[None, None, Some(3), Some(43)]), kept);
    }

    #[test]
    fn stamps_that_do_not_rise_are_counted_and_missing_ones_are_not() {
        let mut timeline = FileTimeline::new(Rational(1, 1000), [25, 1]);
        for stamp in [Some(0), Some(40), Some(10), None, Some(160), Some(160)] {
            timeline.time_ns(stamp);
        }
        assert_eq!(timeline.repaired(), 2);
    }

    #[test]
    fn stamps_that_start_again_go_on_from_the_last_frame() {
        let stamps = [Some(90_000), Some(90_040), Some(0), Some(15), Some(55)];
        assert_eq!(times(&stamps), [0, 40 * MS, 80 * MS, 95 * MS, 135 * MS]);
    }

    proptest! {
        #[test]
        fn times_rise_strictly_from_zero_for_any_stamps(
            stamps in prop::collection::vec(prop::option::of(any::<i64>()), 1..50),
        ) {
            let times = times(&stamps);
            prop_assert_eq!(times[0], 0);
            prop_assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}
