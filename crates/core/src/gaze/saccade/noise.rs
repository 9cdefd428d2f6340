//! How much does a resting gaze seem to move, because of noise?
//!
//! The running median of speed: saccades are too rare to move it. Kept as a histogram, so that a
//! sample costs the same whatever the rate.

use crate::units::Seconds;

/// Width of a bin in degrees per second.
const BIN_DEG_PER_S: f64 = 0.5;
/// Bins; faster speeds count in the last.
const BINS: usize = 256;
/// Speeds that are remembered: 0.6 s at one per two milliseconds.
const CAPACITY: usize = 320;
/// Least time between two speeds that count, in seconds: neighbours say the same.
const SPACING_S: f64 = 0.002;

/// The median speed of the last while.
#[derive(Clone, Debug)]
pub(super) struct RunningNoise {
    memory: f64,
    counts: [u16; BINS],
    speeds: [(f64, u16); CAPACITY],
    oldest: usize,
    count: usize,
}

impl RunningNoise {
    /// Remembers speeds for `memory`.
    pub(super) fn new(memory: Seconds) -> Self {
        Self {
            memory: memory.0,
            counts: [0; BINS],
            speeds: [(0.0, 0); CAPACITY],
            oldest: 0,
            count: 0,
        }
    }

    /// Adds a speed; times must grow.
    pub(super) fn push(&mut self, time: Seconds, deg_per_s: f64) {
        let last = (self.oldest + self.count + CAPACITY - 1) % CAPACITY;
        // Half a tenth of a millisecond of tolerance: stamps are rounded.
        if self.count > 0 && time.0 - self.speeds[last].0 < SPACING_S - 5e-5 {
            return;
        }
        while self.count > 0
            && (self.count == CAPACITY || self.speeds[self.oldest].0 < time.0 - self.memory)
        {
            self.counts[usize::from(self.speeds[self.oldest].1)] -= 1;
            self.oldest = (self.oldest + 1) % CAPACITY;
            self.count -= 1;
        }
        let bin = ((deg_per_s / BIN_DEG_PER_S) as usize).min(BINS - 1);
        self.counts[bin] += 1;
        self.speeds[(self.oldest + self.count) % CAPACITY] = (time.0, bin as u16);
        self.count += 1;
    }

    /// The median in degrees per second, to half a bin, and of how many speeds.
    pub(super) fn median(&self) -> (f64, usize) {
        let mut before = 0;
        for (bin, &count) in self.counts.iter().enumerate() {
            before += usize::from(count);
            if 2 * before > self.count {
                return ((bin as f64 + 0.5) * BIN_DEG_PER_S, self.count);
            }
        }
        (0.0, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_that_of_the_sorted_speeds_of_the_last_while() {
        for step in [0.002, 0.004, 1.0 / 60.0] {
            let mut noise = RunningNoise::new(Seconds(0.6));
            let mut all = Vec::new();
            for k in 0..2000_u32 {
                let time = f64::from(k) * step;
                let speed = f64::from(k.wrapping_mul(2_654_435_761) >> 20) / 40.0;
                noise.push(Seconds(time), speed);
                all.push((time, speed));
                let mut last: Vec<f64> = all
                    .iter()
                    .filter(|s| s.0 >= time - 0.6)
                    .map(|s| s.1)
                    .collect();
                last.sort_by(f64::total_cmp);
                let middle = last[last.len() / 2];
                let (median, _) = noise.median();
                assert!((median - middle).abs() <= 0.51, "{median} for {middle}");
            }
        }
    }

    #[test]
    fn a_thousand_samples_a_second_are_thinned_to_what_is_remembered() {
        let mut noise = RunningNoise::new(Seconds(0.6));
        for k in 0..5000 {
            noise.push(
                Seconds(f64::from(k) * 1e-3),
                if k < 4000 { 10.0 } else { 30.0 },
            );
        }
        assert_eq!(noise.median().0, 30.25);
        assert!((299..=301).contains(&noise.median().1));
    }
}
