//! How fast does a direction move, seen through a window of fixed time?
//!
//! The slope of the least-squares line through the unit directions of the last milliseconds. A
//! window fixed in samples would drown in noise at high rates and smear saccades at low ones.

use crate::units::Seconds;
use glam::DVec3;

/// Most samples that a window holds: 14 ms at 2000 Hz. Faster sources lose their oldest.
const CAPACITY: usize = 32;

/// The samples of the last milliseconds.
#[derive(Clone, Debug)]
pub(super) struct SlopeWindow {
    length: f64,
    samples: [(f64, DVec3); CAPACITY],
    newest: usize,
    count: usize,
}

impl SlopeWindow {
    /// A window that covers `length`, or two samples where they lie further apart.
    pub(super) fn new(length: Seconds) -> Self {
        Self {
            length: length.0,
            samples: [(0.0, DVec3::ZERO); CAPACITY],
            newest: 0,
            count: 0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a sample; times must grow.
    pub(super) fn push(&mut self, time: Seconds, direction: DVec3) {
        self.newest = (self.newest + 1) % CAPACITY;
        self.samples[self.newest] = (time.0, direction);
        self.count = (self.count + 1).min(CAPACITY);
        // A tenth of a millisecond of tolerance: stamps are rounded.
        while self.count > 2 && self.oldest().0 < time.0 - self.length - 1e-4 {
            self.count -= 1;
        }
    }

    /// The oldest sample of the window: time in seconds and direction.
    pub(super) fn oldest(&self) -> (f64, DVec3) {
        self.back(self.count.max(1) - 1)
    }

    fn back(&self, age: usize) -> (f64, DVec3) {
        self.samples[(self.newest + CAPACITY - age) % CAPACITY]
    }

    /// Velocity over the window in radians per second, tangent to the sphere but for the chord's
    /// error (1 part in 1000 for a window of 9°); `None` with fewer than two samples.
    pub(super) fn velocity(&self) -> Option<DVec3> {
        if self.count < 2 {
            return None;
        }
        let newest = self.back(0).0;
        let mean_age = (0..self.count)
            .map(|k| newest - self.back(k).0)
            .sum::<f64>()
            / self.count as f64;
        let (mut weighted, mut squares) = (DVec3::ZERO, 0.0);
        for (time, direction) in (0..self.count).map(|k| self.back(k)) {
            let lever = mean_age - (newest - time);
            weighted += direction * lever;
            squares += lever * lever;
        }
        (squares > 0.0).then(|| weighted / squares)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Radians;
    use crate::view::axes::direction_from_yaw_pitch;

    #[test]
    fn a_steady_turn_has_its_speed_at_every_rate() {
        for rate in [60.0, 90.0, 250.0, 500.0, 1000.0, 4000.0] {
            let mut window = SlopeWindow::new(Seconds(0.010));
            for k in 0..60 {
                let time = f64::from(k) / rate;
                window.push(
                    Seconds(time),
                    direction_from_yaw_pitch(Radians(2.0 * time), Radians(0.0)),
                );
            }
            let speed = window.velocity().unwrap().length();
            assert!((speed - 2.0).abs() < 1e-3, "{speed} at {rate} Hz");
        }
    }

    #[test]
    fn one_sample_has_no_speed() {
        let mut window = SlopeWindow::new(Seconds(0.010));
        window.push(Seconds(0.0), DVec3::X);
        assert!(window.velocity().is_none());
    }
}
