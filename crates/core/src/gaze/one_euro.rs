//! How is a noisy gaze made steady without making it late?
//!
//! The 1 € filter of Casiez, Roussel and Vogel 2012: a low-pass filter whose cutoff grows with
//! speed. Even so it would trail a saccade; [`GazeFilter`] restarts while the eye jumps.

use super::sample::EyeEvent;
use crate::units::Seconds;
use glam::DVec3;

/// Parameters of the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneEuroConfig {
    /// Cutoff of a value that does not move, in hertz.
    pub min_cutoff_hz: f64,
    /// Growth of the cutoff, in hertz per unit of speed (for directions, per radian per second).
    pub beta: f64,
    /// Cutoff of the speed, in hertz.
    pub speed_cutoff_hz: f64,
}

impl Default for OneEuroConfig {
    /// For directions: a third of the noise at rest at 500 Hz, 20 ms behind pursuit of 20°/s.
    fn default() -> Self {
        Self {
            min_cutoff_hz: 2.0,
            beta: 20.0,
            speed_cutoff_hz: 1.0,
        }
    }
}

/// The filter on vectors, with one cutoff from the length of the filtered velocity, so that no
/// axis is preferred. On a vector with one component it is Algorithm 1 of the paper.
#[derive(Clone, Copy, Debug)]
pub struct OneEuro {
    config: OneEuroConfig,
    state: Option<State>,
}

#[derive(Clone, Copy, Debug)]
struct State {
    time: Seconds,
    value: DVec3,
    velocity: DVec3,
}

impl OneEuro {
    /// A filter that has seen nothing.
    #[must_use]
    pub fn new(config: OneEuroConfig) -> Self {
        Self {
            config,
            state: None,
        }
    }

    /// Forgets everything: the next value comes out as it goes in.
    pub fn reset(&mut self) {
        self.state = None;
    }

    /// Filters a value (Algorithm 1). A value that is not finite, or whose time is not finite or
    /// does not grow, changes nothing: the last result comes again.
    pub fn next(&mut self, time: Seconds, value: DVec3) -> DVec3 {
        let sound = time.0.is_finite() && value.is_finite();
        let Some(last) = self.state else {
            if sound {
                self.state = Some(State {
                    time,
                    value,
                    velocity: DVec3::ZERO,
                });
            }
            return value;
        };
        let interval = time.0 - last.time.0;
        if !sound || interval <= 0.0 {
            return last.value;
        }
        let velocity = (value - last.value) / interval;
        let velocity = low_pass(
            velocity,
            last.velocity,
            alpha(interval, self.config.speed_cutoff_hz),
        );
        let cutoff = self.config.min_cutoff_hz + self.config.beta * velocity.length();
        let value = low_pass(value, last.value, alpha(interval, cutoff));
        self.state = Some(State {
            time,
            value,
            velocity,
        });
        value
    }
}

/// Weight of the newest value: Casiez et al. 2012, equations 5 and 6.
fn alpha(interval: f64, cutoff_hz: f64) -> f64 {
    let tau = 1.0 / (2.0 * core::f64::consts::PI * cutoff_hz);
    1.0 / (1.0 + tau / interval)
}

/// Exponential smoothing: Casiez et al. 2012, equation 1.
fn low_pass(newest: DVec3, smoothed: DVec3, alpha: f64) -> DVec3 {
    newest * alpha + smoothed * (1.0 - alpha)
}

/// The filter on gaze directions; it lets saccades through as they are.
#[derive(Clone, Copy, Debug)]
pub struct GazeFilter {
    filter: OneEuro,
}

impl Default for GazeFilter {
    fn default() -> Self {
        Self::new(OneEuroConfig::default())
    }
}

impl GazeFilter {
    /// A filter that has seen nothing.
    #[must_use]
    pub fn new(config: OneEuroConfig) -> Self {
        Self {
            filter: OneEuro::new(config),
        }
    }

    /// Filters the unit direction of a sample of which a detector says `event`. In a saccade, and
    /// when there is no eye, the direction comes back unchanged and the filter restarts.
    pub fn next(&mut self, time: Seconds, direction: DVec3, event: EyeEvent) -> DVec3 {
        if event != EyeEvent::Fixation {
            self.filter.reset();
        }
        let smooth = self.filter.next(time, direction);
        if event == EyeEvent::Fixation {
            smooth.try_normalize().unwrap_or(direction)
        } else {
            direction
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Radians;
    use crate::view::axes::{angle_between, direction_from_yaw_pitch};
    use crate::view::random::Random;

    /// Algorithm 1 as it stands in the paper, of one number.
    #[derive(Default)]
    struct AsPrinted {
        first_time_is_over: bool,
        x_hat_prev: f64,
        dx_hat_prev: f64,
    }

    impl AsPrinted {
        fn filter(&mut self, x: f64, rate: f64, mincutoff: f64, beta: f64, dcutoff: f64) -> f64 {
            let alpha = |rate: f64, cutoff: f64| {
                let tau = 1.0 / (2.0 * std::f64::consts::PI * cutoff);
                let te = 1.0 / rate;
                1.0 / (1.0 + tau / te)
            };
            if !self.first_time_is_over {
                self.first_time_is_over = true;
                self.x_hat_prev = x;
                return x;
            }
            let dx = (x - self.x_hat_prev) * rate;
            let a = alpha(rate, dcutoff);
            let edx = a * dx + (1.0 - a) * self.dx_hat_prev;
            self.dx_hat_prev = edx;
            let a = alpha(rate, mincutoff + beta * edx.abs());
            self.x_hat_prev = a * x + (1.0 - a) * self.x_hat_prev;
            self.x_hat_prev
        }
    }

    #[test]
    fn on_one_number_it_is_the_published_algorithm() {
        for (min_cutoff_hz, beta, speed_cutoff_hz) in [
            (1.0, 0.1, 1.0),
            (1.0, 0.0, 1.0),
            (2.0, 20.0, 1.0),
            (0.3, 1.5, 7.0),
        ] {
            let config = OneEuroConfig {
                min_cutoff_hz,
                beta,
                speed_cutoff_hz,
            };
            let (mut ours, mut printed) = (OneEuro::new(config), AsPrinted::default());
            let mut random = Random::new(5);
            let mut time = 0.0;
            for k in 0..2000 {
                let before = time;
                time += 0.001 + 0.02 * random.unit();
                let x = (f64::from(k) * 0.01).sin() * 4.0 + random.unit();
                let rate = 1.0 / (time - before);
                let expected = printed.filter(x, rate, min_cutoff_hz, beta, speed_cutoff_hz);
                let got = ours.next(Seconds(time), DVec3::new(x, 0.0, 0.0));
                assert!((got.x - expected).abs() < 1e-12, "{} for {expected}", got.x);
            }
        }
    }

    #[test]
    fn a_resting_gaze_gets_steadier_and_a_jump_comes_through_at_once() {
        let mut filter = GazeFilter::default();
        let mut random = Random::new(2);
        let (mut raw, mut smooth) = (0.0, 0.0);
        let mut at = |yaw: f64| {
            let noise = |r: &mut Random| 1e-3 * (r.unit() - 0.5);
            direction_from_yaw_pitch(
                Radians(yaw + noise(&mut random)),
                Radians(noise(&mut random)),
            )
        };
        for k in 0..1000_u32 {
            let (time, direction) = (Seconds(f64::from(k) * 0.002), at(0.1));
            let filtered = filter.next(time, direction, EyeEvent::Fixation);
            let target = direction_from_yaw_pitch(Radians(0.1), Radians(0.0));
            if k > 100 {
                raw += angle_between(direction, target).0;
                smooth += angle_between(filtered, target).0;
            }
        }
        assert!(smooth < 0.4 * raw, "{smooth} of {raw}");
        let jumped = at(0.3);
        assert_eq!(filter.next(Seconds(2.0), jumped, EyeEvent::Saccade), jumped);
        let landed = at(0.32);
        let after = filter.next(Seconds(2.002), landed, EyeEvent::Fixation);
        assert!(angle_between(after, jumped).0 <= angle_between(landed, jumped).0);
    }

    #[test]
    fn time_that_does_not_grow_and_values_that_are_none_change_nothing() {
        let mut filter = OneEuro::new(OneEuroConfig::default());
        filter.next(Seconds(1.0), DVec3::X);
        let known = filter.next(Seconds(1.1), DVec3::Y);
        for (time, value) in [
            (1.1, DVec3::Z),
            (0.5, DVec3::Z),
            (f64::NAN, DVec3::Z),
            (1.2, DVec3::NAN),
            (f64::INFINITY, DVec3::Z),
        ] {
            assert_eq!(filter.next(Seconds(time), value), known);
        }
        assert!(filter.next(Seconds(1.2), DVec3::Z).is_finite());
    }
}
