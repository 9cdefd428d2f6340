//! Which moment of the content is due now?
//!
//! Content runs at its own rate against a clock that whoever asks passes in: a monotonic one, which
//! the sound that is heard corrects.

use crate::units::Seconds;

/// From this difference on the picture jumps to the sound instead of gliding.
const JUMP_S: f64 = 0.2;
/// Share of a smaller difference that one look at the sound takes away.
const GLIDE: f64 = 0.1;

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
        let off = heard.0 - self.time(now).0;
        if self.is_playing() {
            self.at += if off.abs() > JUMP_S { off } else { off * GLIDE };
        }
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
}
