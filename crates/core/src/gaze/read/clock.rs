//! What is a source's time by our clock?
//!
//! Nobody can tell a clock that is behind from a message that was slow; but delays have a floor
//! that is reached again and again. So the smallest difference between arrival and source time,
//! over the last half minute to minute, counts as no delay at all, and what a sample took beyond
//! it is its delay.

use crate::units::Seconds;

/// Length of the windows over which the smallest delay is taken, in seconds; short enough for
/// clocks that drift apart by 100 parts per million to stay within some milliseconds.
const WINDOW_S: f64 = 30.0;

/// A source whose time falls back by more than this, in seconds, has begun anew; by less, a
/// message was overtaken.
const BEGUN_ANEW_S: f64 = 1.0;

/// A source whose time leaps this much further than ours, in seconds, has set its clock.
const LEAP_S: f64 = 10.0;

/// Least step of time between two samples of a stream where a source begins anew, in seconds.
const LEAST_STEP_S: f64 = 1e-6;

/// When a sample was made and when it came, in seconds since the first sample was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamp {
    /// When it was made.
    pub time: Seconds,
    /// When it came; never before `time`.
    pub received: Seconds,
}

/// Maps the times of one source and ours onto one time that begins at 0 with the first sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceClock {
    state: Option<State>,
    anew: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct State {
    /// Source time at 0.
    base: f64,
    last_source: f64,
    last_arrived: f64,
    last_time: f64,
    /// Smallest difference of arrival and stream time, in this window and the one before.
    least: [f64; 2],
    window_begun: f64,
}

impl SourceClock {
    /// The stamp of a sample made at `source` by the source's clock that arrived at `arrived` by
    /// ours; `None` where one made later (or then) came before. Arrivals must not decrease.
    pub fn stamp(&mut self, source: Seconds, arrived: Seconds) -> Option<Stamp> {
        let (source, arrived) = (source.0, arrived.0);
        let state = self.state.get_or_insert(State {
            base: source,
            last_source: f64::NEG_INFINITY,
            last_arrived: arrived,
            last_time: f64::NEG_INFINITY,
            least: [arrived; 2],
            window_begun: arrived,
        });
        let (step, waited) = (source - state.last_source, arrived - state.last_arrived);
        let anew = step < -BEGUN_ANEW_S || step - waited > LEAP_S;
        if anew && state.last_time.is_finite() {
            let time = state.last_time + waited.max(LEAST_STEP_S);
            state.base = source - time;
            state.least = [arrived - time; 2];
            state.window_begun = arrived;
            self.anew += 1;
        }
        let time = source - state.base;
        if time <= state.last_time {
            return None;
        }
        (state.last_source, state.last_arrived, state.last_time) = (source, arrived, time);
        state.learn(arrived - time, arrived);
        let received = Seconds(arrived - state.delay()).0.max(time);
        Some(Stamp {
            time: Seconds(time),
            received: Seconds(received),
        })
    }

    /// How often the source's clock began anew, or leapt.
    #[must_use]
    pub fn anew(&self) -> u64 {
        self.anew
    }

    /// The stream's time at `ours`; 0 before the first sample.
    #[must_use]
    pub fn now(&self, ours: Seconds) -> Seconds {
        let state = self.state.as_ref();
        Seconds(state.map_or(0.0, |state| ours.0 - state.delay()))
    }

    /// The source's own time of the stream's 0, once a sample came.
    #[must_use]
    pub fn start(&self) -> Option<Seconds> {
        self.state.as_ref().map(|state| Seconds(state.base))
    }
}

impl State {
    fn learn(&mut self, difference: f64, arrived: f64) {
        if arrived - self.window_begun > WINDOW_S {
            self.least = [difference, self.least[0]];
            self.window_begun = arrived;
        }
        self.least[0] = self.least[0].min(difference);
    }

    /// Our time less the stream's.
    fn delay(&self) -> f64 {
        self.least[0].min(self.least[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::random::Random;

    fn stamp(clock: &mut SourceClock, source: f64, arrived: f64) -> Option<[f64; 2]> {
        let stamp = clock.stamp(Seconds(source), Seconds(arrived))?;
        Some([stamp.time.0, stamp.received.0])
    }

    #[test]
    fn delays_beyond_the_smallest_are_found_whatever_the_clocks_say() {
        let (mut clock, mut random) = (SourceClock::default(), Random::new(3));
        for n in 0..2000 {
            let made = f64::from(n) * 0.01;
            let delay = if n % 50 == 0 {
                0.0
            } else {
                0.02 * random.unit()
            };
            let stamp = stamp(&mut clock, made + 5e5, made + 77.0 + 0.03 + delay).unwrap();
            assert!((stamp[0] - made).abs() < 1e-9);
            assert!((stamp[1] - stamp[0] - delay).abs() < 1e-9, "{n} {stamp:?}");
        }
    }

    #[test]
    fn a_clock_that_drifts_is_followed() {
        let mut clock = SourceClock::default();
        for n in 0..60_000 {
            let ours = f64::from(n) * 0.01;
            // 200 parts per million slow: 120 ms in ten minutes.
            let stamp = stamp(&mut clock, ours * 0.9998, ours).unwrap();
            assert!(stamp[1] - stamp[0] < 0.013 && stamp[1] >= stamp[0]);
        }
    }

    #[test]
    fn what_was_overtaken_is_left_out_and_a_source_that_begins_anew_goes_on() {
        let mut clock = SourceClock::default();
        assert!(stamp(&mut clock, 50.0, 0.0).is_some());
        assert!(stamp(&mut clock, 50.1, 0.1).is_some());
        assert_eq!(stamp(&mut clock, 50.05, 0.11), None);
        assert_eq!(stamp(&mut clock, 50.1, 0.12), None);
        let [time, received] = stamp(&mut clock, 0.0, 3.1).unwrap();
        assert!((time - 3.1).abs() < 1e-9 && (received - 3.1).abs() < 1e-9);
        // One mad stamp does not silence the sane ones after it.
        assert_eq!(clock.anew(), 1);
        assert!(stamp(&mut clock, 1e9, 3.2).is_some());
        let [time, _] = stamp(&mut clock, 0.2, 3.3).unwrap();
        assert!((time - 3.3).abs() < 1e-6, "{time}");
    }
}
