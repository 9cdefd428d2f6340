//! What is a source's time by our clock?
//!
//! A clock that is behind looks the same as a message that was slow; but delays have a floor
//! that is reached again and again. So the smallest difference between arrival and source time,
//! over the last half minute to minute, counts as no delay at all, and what a sample took beyond
//! it is its delay.
//!
//! A clock that leaps ahead again and again, or does not move, is of no use. Arrivals then take
//! the place of its times, until it has gone as ours does for half a minute.

use crate::units::Seconds;

/// Length of the windows over which the smallest delay is taken, in seconds; short enough for
/// clocks that drift apart by 100 parts per million to stay within some milliseconds.
const WINDOW_S: f64 = 30.0;

/// A source whose time falls back by more than this, in seconds, has restarted; by less, a
/// message was overtaken.
const BEGUN_ANEW_S: f64 = 1.0;

/// A source whose time leaps this much further than ours, in seconds, has set its clock.
const LEAP_S: f64 = 10.0;

/// A step that is longer than ours by more than this, in seconds, is a leap: longer than the
/// hiccups of a network, so that what comes late and all at once is none.
const LEAST_LEAP_S: f64 = 0.25;

/// Samples in a row that are not newer than one before, over more than [`BEGUN_ANEW_S`], of a clock
/// that does not move.
const MOST_LATE: u32 = 8;

/// Least step of time between two samples of a stream where a source restarts, in seconds.
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
    untimed: u64,
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
    /// How far the source leapt ahead of ours, in this window and the one before, in seconds.
    leapt: [f64; 2],
    /// Samples since the last one that was newer.
    late: u32,
    /// Source time and arrival since when a clock that is not trusted has gone as ours does.
    broken: Option<(f64, f64)>,
}

impl SourceClock {
    /// The stamp of a sample made at `source` by the source's clock that arrived at `arrived` by
    /// ours; `None` where one made later (or then) came before. Arrivals must not decrease.
    pub fn stamp(&mut self, source: Seconds, arrived: Seconds) -> Option<Stamp> {
        let (source, arrived) = (source.0, arrived.0);
        let state = self.state.get_or_insert(State::at(source, arrived));
        let (step, waited) = (source - state.last_source, arrived - state.last_arrived);
        if state.is_broken(source, arrived, step - waited) {
            self.untimed += 1;
            state.last_source = source;
            return Some(state.by_arrival(arrived));
        }
        let anew = step < -BEGUN_ANEW_S || step - waited > LEAP_S;
        if anew && state.last_time.is_finite() {
            state.go_on(source, arrived);
            self.anew += 1;
        }
        let time = source - state.base;
        if time <= state.last_time {
            state.late = state.late.saturating_add(1);
            return None;
        }
        state.late = 0;
        (state.last_source, state.last_arrived, state.last_time) = (source, arrived, time);
        state.learn(arrived - time, arrived);
        let received = Seconds(arrived - state.delay()).0.max(time);
        Some(Stamp {
            time: Seconds(time),
            received: Seconds(received),
        })
    }

    /// How often the source's clock restarted or leapt.
    #[must_use]
    pub fn anew(&self) -> u64 {
        self.anew
    }

    /// How many samples were stamped by their arrival, since the source's clock leaps or stands.
    #[must_use]
    pub fn untimed(&self) -> u64 {
        self.untimed
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
    /// Before the first sample, which was made at `source`.
    fn at(source: f64, arrived: f64) -> Self {
        Self {
            base: source,
            last_source: f64::NEG_INFINITY,
            last_arrived: arrived,
            last_time: f64::NEG_INFINITY,
            least: [arrived; 2],
            window_begun: arrived,
            leapt: [0.0; 2],
            late: 0,
            broken: None,
        }
    }

    /// Goes on where the stream was, whatever the source's time is.
    fn go_on(&mut self, source: f64, arrived: f64) {
        let waited = arrived - self.last_arrived;
        let time = self.last_time + waited.max(LEAST_STEP_S);
        self.base = source - time;
        self.least = [arrived - time; 2];
        self.window_begun = arrived;
        self.late = 0;
    }

    /// Whether arrivals count in the place of the source's times, for a sample whose source went
    /// `ahead` further than ours did since the last one.
    fn is_broken(&mut self, source: f64, arrived: f64, ahead: f64) -> bool {
        if !self.last_time.is_finite() {
            return false;
        }
        if let Some((source_then, arrived_then)) = self.broken {
            let apart = (source - source_then) - (arrived - arrived_then);
            if apart.abs() > BEGUN_ANEW_S || ahead > LEAST_LEAP_S {
                self.broken = Some((source, arrived));
            } else if arrived - arrived_then > WINDOW_S {
                self.broken = None;
                self.leapt = [0.0; 2];
                self.go_on(source, arrived);
            }
            return self.broken.is_some();
        }
        if ahead > LEAST_LEAP_S {
            self.leapt[0] += ahead.min(LEAP_S);
        }
        let stands = self.late >= MOST_LATE && arrived - self.last_arrived > BEGUN_ANEW_S;
        if stands || self.leapt[0] + self.leapt[1] > LEAP_S {
            self.broken = Some((source, arrived));
            self.go_on(source, arrived);
        }
        self.broken.is_some()
    }

    /// The stamp of what arrives now, later than any before, and known at once.
    fn by_arrival(&mut self, arrived: f64) -> Stamp {
        let waited = arrived - self.last_arrived;
        let time = self.last_time + waited.max(LEAST_STEP_S);
        (self.last_arrived, self.last_time) = (arrived, time);
        self.least = [arrived - time; 2];
        Stamp {
            time: Seconds(time),
            received: Seconds(time),
        }
    }

    fn learn(&mut self, difference: f64, arrived: f64) {
        if arrived - self.window_begun > WINDOW_S {
            self.least = [difference, self.least[0]];
            self.leapt = [0.0, self.leapt[0]];
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

    #[test]
    fn arrivals_take_the_place_of_a_clock_that_leaps_or_stands() {
        let clocks: [fn(f64) -> f64; 5] = [
            // By just under ten seconds at every sample, as of a sender that means milliseconds.
            |n| n * 9.99,
            |n| n * 0.9,
            |n| n * 11.0,
            |_| 50.0,
            |n| -0.01 * n,
        ];
        for (number, source) in clocks.into_iter().enumerate() {
            let mut clock = SourceClock::default();
            let (mut last, mut came) = (f64::NEG_INFINITY, 0);
            for n in 0..1000 {
                let n = f64::from(n);
                let Some([time, received]) = stamp(&mut clock, source(n), 3.0 + n * 0.01) else {
                    continue;
                };
                assert!(time > last && received >= time, "{number}: {n}");
                let is_real = (time - last - 0.01).abs() < 1e-6;
                came += u32::from(is_real);
                last = time;
            }
            assert!(came > 850, "{number}: {came}");
            assert!(clock.untimed() > 850 && clock.anew() <= 2, "{number}");
            let now = clock.now(Seconds(13.0)).0;
            assert!((now - last).abs() < 0.02, "{number}: {now} {last}");
        }
    }

    #[test]
    fn a_clock_that_goes_as_ours_again_is_trusted_again() {
        let mut clock = SourceClock::default();
        for n in 0..10_000 {
            let arrived = f64::from(n) * 0.01;
            let source = arrived + if n < 100 { f64::from(n) * 9.9 } else { 0.0 };
            assert!(stamp(&mut clock, source, arrived).is_some(), "{n}");
        }
        let untimed = clock.untimed();
        assert!((3000..3300).contains(&untimed), "{untimed}");
        let stamps = [(100.0, 100.02), (100.01, 100.03)]
            .map(|(source, arrived)| stamp(&mut clock, source, arrived).unwrap());
        assert!((stamps[1][0] - stamps[0][0] - 0.01).abs() < 1e-9);
        assert_eq!(clock.untimed(), untimed);
    }

    #[test]
    fn what_comes_late_and_all_at_once_breaks_no_clock() {
        let mut clock = SourceClock::default();
        for n in 0..6000 {
            let made = f64::from(n) * 0.01;
            // A network that holds back 20 s of samples of an eye that is lost for whole seconds.
            if n % 300 < 100 {
                continue;
            }
            let arrived = if n < 2000 { 20.0 } else { made };
            let [time, _] = stamp(&mut clock, made, arrived).unwrap();
            let first = 1.0;
            assert!((time - made + first).abs() < 1e-9, "{n} {time}");
        }
        assert_eq!([clock.untimed(), clock.anew()], [0, 0]);
    }
}
