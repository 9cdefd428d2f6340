//! Which frame of the content is shown at a time?
//!
//! Content that is played again and again is counted on: a tick is a frame of one round.

use crate::units::Seconds;

/// The frames of a pack in time.
#[derive(Clone, Debug)]
pub struct Timeline {
    /// When each frame begins, from 0, never falling.
    begins: Vec<f64>,
    /// Length of a round.
    length: f64,
}

impl Timeline {
    /// The frames that begin at these times; the last lasts `period`.
    pub fn new(times_ns: &[i64], period: Seconds) -> Self {
        let first = times_ns.first().copied().unwrap_or_default();
        let mut latest = 0.0f64;
        let begins: Vec<f64> = times_ns
            .iter()
            .map(|time| {
                latest = latest.max((time - first) as f64 / 1e9);
                latest
            })
            .collect();
        Self {
            length: latest + period.0.max(1e-3),
            begins,
        }
    }

    /// Frames of a round.
    pub fn frames(&self) -> u64 {
        self.begins.len() as u64
    }

    /// Whether nothing ever moves.
    pub fn is_still(&self) -> bool {
        self.begins.len() < 2
    }

    /// Length of a round.
    pub fn length(&self) -> Seconds {
        Seconds(self.length)
    }

    /// The tick that is due at a time; of a still there is one.
    pub fn tick_at(&self, time: Seconds) -> u64 {
        if self.is_still() {
            return 0;
        }
        // A clock that was set to the beginning of a frame is in that frame.
        let time = time.0.max(0.0) + 1e-7;
        let round = (time / self.length).floor();
        let within = time - round * self.length;
        let begun = self.begins.partition_point(|begin| *begin <= within);
        round as u64 * self.frames() + begun.max(1) as u64 - 1
    }

    /// When a tick begins.
    pub fn time_of(&self, tick: u64) -> Seconds {
        let round = (tick / self.frames()) as f64;
        Seconds(round * self.length + self.begins[(tick % self.frames()) as usize])
    }

    /// The frame of a tick.
    pub fn frame_of(&self, tick: u64) -> u32 {
        (tick % self.frames()) as u32
    }

    /// Time within a round.
    pub fn within(&self, time: Seconds) -> Seconds {
        Seconds(time.0.rem_euclid(self.length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tick_is_due_from_its_beginning_until_the_next() {
        let timeline = Timeline::new(&[10, 33_000_010, 70_000_000, 70_000_000], Seconds(0.03));
        for tick in 0..12 {
            let begin = timeline.time_of(tick);
            let same_time = tick % 4 == 2;
            assert_eq!(
                timeline.tick_at(begin),
                tick + u64::from(same_time),
                "{tick}"
            );
        }
        assert_eq!(timeline.frame_of(7), 3);
        assert_eq!(timeline.tick_at(Seconds(0.0329)), 0);
        assert!((timeline.within(Seconds(0.1)).0 - 0.000_000_01).abs() < 1e-7);
    }

    #[test]
    fn a_still_has_one_frame_for_ever() {
        let still = Timeline::new(&[0], Seconds(0.04));
        assert!(still.is_still());
        assert_eq!(still.tick_at(Seconds(77.7)), 0);
    }
}
