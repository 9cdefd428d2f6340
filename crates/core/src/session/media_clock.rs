//! Which moment of the content is due now?
//!
//! Content runs at its own rate against a clock that the caller passes in: a monotonic one, which
//! the sound that is heard corrects.

use crate::units::Seconds;

/// From this difference on the picture jumps to the sound instead of gliding.
const JUMP_S: f64 = 0.2;
/// A smaller difference is halved by a look at the sound this long after the last one; by more
/// frequent looks it falls to about a third in this time.
const GLIDE_S: f64 = 0.15;

/// Time in the content, counted on through all its rounds; by default paused at the beginning.
#[derive(Clone, Copy, Debug, Default)]
pub struct MediaClock {
    at: f64,
    /// When it was `at`; `None` while paused.
    since: Option<f64>,
}

impl MediaClock {
    /// Time in the content.
    pub fn time(&self, now: Seconds) -> Seconds {
        let passed = self.since.map_or(0.0, |since| (now.0 - since).max(0.0));
        Seconds(self.at + passed)
    }

    /// Whether time runs.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.since.is_some()
    }

    /// Runs from `now` on.
    pub fn play(&mut self, now: Seconds) {
        self.since = self.since.or(Some(now.0));
    }

    /// Stops at `at`, the time of the frame on screen.
    pub fn pause(&mut self, at: Seconds) {
        self.at = at.0;
        self.since = None;
    }

    /// Goes on from another time of the content, playing or paused as before.
    pub fn seek(&mut self, to: Seconds, now: Seconds) {
        self.at = to.0.max(0.0);
        self.since = self.since.map(|_| now.0);
    }

    /// Comes closer to what is heard.
    pub fn follow(&mut self, heard: Seconds, now: Seconds) {
        let Some(since) = self.since else {
            return;
        };
        let at = self.time(now).0;
        let (off, passed) = (heard.0 - at, (now.0 - since).max(0.0));
        let glides = off.abs() <= JUMP_S;
        let share = if glides {
            passed / (passed + GLIDE_S)
        } else {
            1.0
        };
        self.at = at + off * share;
        self.since = Some(since.max(now.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_runs_only_while_it_plays() {
        let mut clock = MediaClock::default();
        assert_eq!(clock.time(Seconds(5.0)), Seconds(0.0));
        clock.play(Seconds(5.0));
        clock.play(Seconds(6.0));
        assert_eq!(clock.time(Seconds(7.0)), Seconds(2.0));
        clock.pause(Seconds(1.9));
        assert_eq!(clock.time(Seconds(100.0)), Seconds(1.9));
        clock.seek(Seconds(-3.0), Seconds(100.0));
        clock.play(Seconds(100.0));
        clock.seek(Seconds(8.0), Seconds(101.0));
        assert_eq!(clock.time(Seconds(101.5)), Seconds(8.5));
    }

    #[test]
    fn the_picture_comes_to_a_sound_that_runs_fast_and_stays_within_forty_milliseconds() {
        let mut clock = MediaClock::default();
        clock.play(Seconds(0.0));
        let heard = |now: f64| 0.15 + now * 1.001;
        for step in 1..600 {
            let now = f64::from(step) / 60.0;
            clock.follow(Seconds(heard(now)), Seconds(now));
            let off = (heard(now) - clock.time(Seconds(now)).0).abs();
            assert!(step < 60 || off < 0.04, "{off} s at {now} s");
        }
        clock.follow(Seconds(100.0), Seconds(10.0));
        assert!((clock.time(Seconds(10.0)).0 - 100.0).abs() < 1e-9);
    }

    #[test]
    fn a_sound_that_is_listened_to_rarely_is_come_to_as_soon() {
        let off_after = |looks: u32| {
            let mut clock = MediaClock::default();
            clock.play(Seconds(0.0));
            for look in 1..=looks {
                let now = f64::from(look) * 0.6 / f64::from(looks);
                clock.follow(Seconds(now + 0.1), Seconds(now));
            }
            (0.6 + 0.1 - clock.time(Seconds(0.6)).0).abs()
        };
        for looks in [4, 10, 40, 400] {
            assert!(off_after(looks) < 0.01, "{looks}: {} s", off_after(looks));
        }
    }
}
