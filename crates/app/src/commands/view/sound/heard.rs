//! Which moment of the content is heard now, by a device's noisy time stamps?
//!
//! A device takes sound in bursts and reports only roughly when each is heard; the sound itself
//! leaves it evenly. So the stamps are one line with noise round it, and the line is what is heard.

/// Share of a stamp's distance from the line that it moves the line by.
const SHARE: f64 = 0.1;
/// Stamps that count fully at first: each as much as all before it.
const FIRST: u32 = 10;
/// Distance from the line beyond which a stamp is of another line, in seconds.
const ELSEWHERE_S: f64 = 0.08;
/// So many such stamps in a row begin one.
const MOST_ELSEWHERE: u32 = 3;

/// Seconds of sound that a device may take at once, to fill its own memory.
const AT_ONCE_S: f64 = 3.0;
/// How much faster than it is heard a device may take sound after that: clocks differ by far less.
const MOST_RATE: f64 = 1.2;
/// How long it is observed to decide, in seconds.
const LOOK_S: f64 = 0.1;
/// How much faster than it is heard it takes sound in that time, at most, once its memory is full.
const MOST_SATED_RATE: f64 = 1.5;

/// What a device has taken. One that throws sound away takes it as fast as it comes, and does
/// not say when anything is heard.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Appetite {
    opened: f64,
    taken_s: f64,
    /// When it was last looked at, and what it had taken then.
    looked: (f64, f64),
    sated: bool,
}

impl Appetite {
    /// Of a device that is opened at this time, in seconds.
    pub(crate) fn from(opened: f64) -> Self {
        Self {
            opened,
            taken_s: 0.0,
            looked: (opened, 0.0),
            sated: false,
        }
    }

    /// Whether its own memory is full, so that it takes sound as that is heard.
    pub(crate) fn is_sated(&self) -> bool {
        self.sated
    }

    /// Notes seconds of sound that are taken at `now`; returns whether they can all be heard.
    pub(crate) fn takes(&mut self, seconds: f64, now: f64) -> bool {
        self.taken_s += seconds;
        let (then, taken) = self.looked;
        if now - then >= LOOK_S {
            self.sated |= self.taken_s - taken <= MOST_SATED_RATE * (now - then);
            self.looked = (now, self.taken_s);
        }
        self.taken_s <= AT_ONCE_S + MOST_RATE * (now - self.opened)
    }
}

/// The line through a device's stamps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HeardLine {
    /// Time in the content minus that of the wall's clock, when it was last noted, and how often.
    line: Option<Line>,
}

#[derive(Clone, Copy, Debug)]
struct Line {
    offset: f64,
    noted: f64,
    count: u32,
    elsewhere: u32,
}

impl HeardLine {
    /// Notes at `now` that the device plays `time` of the content at `at`, all in seconds.
    pub(crate) fn note(&mut self, now: f64, at: f64, time: f64) {
        let offset = time - at;
        let fresh = Line {
            offset,
            noted: now,
            count: 1,
            elsewhere: 0,
        };
        let Some(line) = &mut self.line else {
            self.line = Some(fresh);
            return;
        };
        line.noted = now;
        let off = offset - line.offset;
        if off.abs() > ELSEWHERE_S {
            line.elsewhere += 1;
            if line.elsewhere >= MOST_ELSEWHERE {
                *line = fresh;
            }
            return;
        }
        line.elsewhere = 0;
        line.count = line.count.saturating_add(1);
        let share = if line.count <= FIRST {
            1.0 / f64::from(line.count)
        } else {
            SHARE
        };
        line.offset += off * share;
    }

    /// Forgets all stamps: what comes is another line.
    pub(crate) fn forget(&mut self) {
        self.line = None;
    }

    /// What is heard at `now`; `None` where nothing was noted for longer than `stale`.
    pub(crate) fn at(&self, now: f64, stale: f64) -> Option<f64> {
        let line = self.line.filter(|line| now - line.noted < stale)?;
        Some(now + line.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Notes a device that takes 20 ms at a time, its clock fast by `rate`, its stamps off by
    /// `noise` of each step; returns the greatest error of the last half.
    fn worst(rate: f64, noise: impl Fn(u32) -> f64) -> f64 {
        let mut line = HeardLine::default();
        let mut worst = 0.0f64;
        for step in 0..400 {
            let now = 7.0 + f64::from(step) * 0.02;
            let played = |at: f64| (at - 7.1) * rate;
            let at = now + 0.1;
            line.note(now, at + noise(step), played(at));
            if step > 200 {
                let heard = line.at(now + 0.005, 0.5).unwrap();
                worst = worst.max((heard - played(now + 0.005)).abs());
            }
        }
        worst
    }

    proptest! {
        #[test]
        fn stamps_that_are_off_by_thirty_milliseconds_are_heard_evenly(
            noise in prop::collection::vec(-0.03..0.03f64, 400),
            rate in 0.9995..1.0005f64,
        ) {
            let mean = noise.iter().sum::<f64>() / 400.0;
            let off = worst(rate, |step| noise[step as usize] - mean);
            prop_assert!(off < 0.025, "{off}");
        }
    }

    #[test]
    fn a_device_that_throws_sound_away_is_found_and_one_with_a_large_memory_is_not() {
        let (mut hears, mut discards) = (Appetite::from(0.0), Appetite::from(0.0));
        assert!(hears.takes(2.5, 0.0));
        assert!((1..4000).all(|step| hears.takes(0.02, f64::from(step) * 0.0198)));
        assert!((1..200).any(|step| !discards.takes(0.02, f64::from(step) * 0.0001)));
    }

    #[test]
    fn a_device_is_sated_once_it_waits_between_what_it_takes() {
        let mut fills = Appetite::from(0.0);
        (0..1000).for_each(|step| {
            fills.takes(0.02, f64::from(step) * 0.001);
            assert!(!fills.is_sated());
        });
        (0..12).for_each(|step| {
            fills.takes(0.02, 1.0 + f64::from(step) * 0.02);
        });
        assert!(fills.is_sated());
    }

    #[test]
    fn a_single_wrong_stamp_moves_nothing() {
        let off = worst(1.0, |step| if step == 250 { 5.0 } else { 0.0 });
        assert!(off < 1e-9, "{off}");
    }

    #[test]
    fn sound_that_went_elsewhere_is_followed_after_three_stamps() {
        let mut line = HeardLine::default();
        (0..50).for_each(|step| line.note(f64::from(step), f64::from(step), f64::from(step)));
        (50..53).for_each(|step| line.note(f64::from(step), f64::from(step), 100.0));
        assert_eq!(line.at(52.0, 0.5), Some(100.0));
        assert_eq!(line.at(53.0, 0.5), None);
        line.forget();
        assert_eq!(line.at(52.0, 0.5), None);
    }
}
