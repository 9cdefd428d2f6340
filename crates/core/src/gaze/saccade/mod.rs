//! Does the eye fixate, jump, blink, or is it lost, as far as can be said now?
//!
//! A causal detector with two thresholds above the running noise, after the adaptive velocity
//! rules of Engbert and Kliegl 2003 and Nyström and Holmqvist 2010: a saccade begins above the
//! high one and ends below the low one, or where its speed begins to rise again.

mod fixed_threshold;
mod guard;
mod noise;
mod velocity;

pub use fixed_threshold::FixedThreshold;

use super::sample::EyeEvent;
use crate::units::{Radians, Seconds};
use glam::DVec3;
use guard::{LossGuard, Signal};
use noise::RunningNoise;
use velocity::SlopeWindow;

/// Parameters of the detector. Speeds are angular speeds of the gaze in degrees per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaccadeConfig {
    /// Length of the window that speed is measured over: 8–14 ms.
    pub window: Seconds,
    /// How long speeds count for the noise.
    pub noise_memory: Seconds,
    /// A saccade begins above `high.0 + high.1 x noise`.
    pub high: [f64; 2],
    /// A saccade ends below `low.0 + low.1 x noise`.
    pub low: [f64; 2],
    /// Time constant with which slow movement (pursuit, drift) is followed and taken away.
    pub slow_memory: Seconds,
    /// Share of the slow speed that is added to both thresholds: pursuit is not even.
    pub slow_share: f64,
    /// Samples above the high threshold that make a saccade...
    pub confirm: u32,
    /// ...unless they lie at least this far apart: then one does.
    pub sparse: Seconds,
    /// Share of the peak that the speed must fall below before a new rise ends the saccade.
    pub valley: f64,
    /// No saccade begins so soon after another: the eye still swings (post-saccadic oscillation).
    pub settle: Seconds,
    /// No saccade is over sooner than this after it was found: noise at its start is no end.
    pub shortest: Seconds,
    /// No saccade lasts longer.
    pub longest: Seconds,
    /// Nothing that an eye does is faster (REMoDNaV's limit): the tracker has lost the pupil.
    pub fastest: f64,
    /// How long the signal is not trusted after a loss.
    pub guard: Seconds,
}

impl Default for SaccadeConfig {
    fn default() -> Self {
        Self {
            window: Seconds(0.008),
            noise_memory: Seconds(0.6),
            high: [20.0, 3.0],
            low: [12.0, 3.0],
            slow_memory: Seconds(0.08),
            slow_share: 0.25,
            confirm: 2,
            sparse: Seconds(0.0045),
            valley: 0.2,
            settle: Seconds(0.04),
            shortest: Seconds(0.008),
            longest: Seconds(0.15),
            fastest: 1000.0,
            guard: Seconds(0.1),
        }
    }
}

/// A saccade that runs, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunningSaccade {
    /// When it began: before it could be known.
    pub onset: Seconds,
    /// When it was known.
    pub found: Seconds,
    /// Where it began, in the detector's space.
    pub from: DVec3,
    /// Time of the newest sample.
    pub now: Seconds,
    /// Direction of the newest sample.
    pub at: DVec3,
    /// Newest speed in degrees per second.
    pub speed_deg_per_s: f64,
    /// Fastest yet, in degrees per second.
    pub peak_deg_per_s: f64,
}

/// What is said of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detection {
    /// What the eye does.
    pub event: EyeEvent,
    /// The saccade, while there is one.
    pub saccade: Option<RunningSaccade>,
}

/// The causal detector: bounded memory (about 8 kB), no allocation, some hundred nanoseconds a
/// sample. Give it directions in one space whose rotation is not the eye's own: the head's, or the
/// content's before a still head.
#[derive(Clone, Debug)]
pub struct SaccadeDetector {
    config: SaccadeConfig,
    guard: LossGuard,
    window: SlopeWindow,
    noise: RunningNoise,
    /// Velocity of pursuit or drift in radians per second.
    slow: DVec3,
    before: Option<Seconds>,
    rise: Rise,
    phase: Phase,
    last: Detection,
}

/// The run of samples above the low threshold that may become a saccade.
#[derive(Clone, Copy, Debug, Default)]
struct Rise {
    onset: Option<(Seconds, DVec3)>,
    above_high: u32,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    Rest,
    Saccade {
        running: RunningSaccade,
        valley: f64,
    },
    Settle {
        end: Seconds,
    },
}

/// Newest speeds in degrees per second: what was measured and what it is compared with.
#[derive(Clone, Copy, Debug)]
struct Speeds {
    now: f64,
    high: f64,
    low: f64,
}

impl Default for SaccadeDetector {
    fn default() -> Self {
        Self::new(SaccadeConfig::default())
    }
}

impl SaccadeDetector {
    /// A detector that has seen nothing.
    #[must_use]
    pub fn new(config: SaccadeConfig) -> Self {
        Self {
            config,
            guard: LossGuard::new(config.guard),
            window: SlopeWindow::new(config.window),
            noise: RunningNoise::new(config.noise_memory),
            slow: DVec3::ZERO,
            before: None,
            rise: Rise::default(),
            phase: Phase::Rest,
            last: Detection::default(),
        }
    }

    /// Forgets everything: another eye, another recording.
    pub fn reset(&mut self) {
        *self = Self::new(self.config);
    }

    /// Says what the eye does at a sample. A sample whose time is not finite or does not grow
    /// changes nothing; a direction that is not finite, or of no length, counts as not valid.
    pub fn next(&mut self, time: Seconds, direction: DVec3, valid: bool) -> Detection {
        if !time.0.is_finite() || self.before.is_some_and(|before| time.0 <= before.0) {
            return self.last;
        }
        let valid = valid && direction.is_finite() && direction.length_squared() > 1e-12;
        self.last = match self.guard.next(time, valid) {
            Signal::Bridged => self.last,
            Signal::Lost(event) => {
                self.lose();
                Detection {
                    event,
                    saccade: None,
                }
            }
            Signal::Returning => {
                self.window.push(time, direction.normalize());
                Detection {
                    event: EyeEvent::Blink,
                    saccade: None,
                }
            }
            Signal::Good => self.watch(time, direction.normalize()),
        };
        self.before = Some(time);
        self.last
    }

    fn lose(&mut self) {
        self.window.clear();
        self.slow = DVec3::ZERO;
        self.rise = Rise::default();
        self.phase = Phase::Rest;
    }

    fn watch(&mut self, time: Seconds, direction: DVec3) -> Detection {
        let interval = self.before.map_or(0.0, |before| time.0 - before.0);
        self.window.push(time, direction);
        let Some(velocity) = self.window.velocity() else {
            return Detection::default();
        };
        if degrees(velocity) > self.config.fastest {
            self.lose();
            self.guard.distrust(time);
            return Detection {
                event: EyeEvent::Blink,
                saccade: None,
            };
        }
        let speeds = self.speeds(velocity);
        self.noise.push(time, speeds.now);
        self.phase = match self.phase {
            Phase::Saccade { running, valley } => {
                let running = RunningSaccade {
                    now: time,
                    at: direction,
                    speed_deg_per_s: speeds.now,
                    peak_deg_per_s: running.peak_deg_per_s.max(speeds.now),
                    ..running
                };
                self.go_on(running, valley, &speeds)
            }
            Phase::Settle { end } if time.0 - end.0 < self.config.settle.0 => self.phase,
            _ => self.rise(interval, time, direction, &speeds),
        };
        match self.phase {
            Phase::Saccade { running, .. } => Detection {
                event: EyeEvent::Saccade,
                saccade: Some(running),
            },
            _ => {
                self.follow_slow(velocity, interval);
                Detection::default()
            }
        }
    }

    fn speeds(&self, velocity: DVec3) -> Speeds {
        let (median, count) = self.noise.median();
        // Before enough is known, the noise of a middling tracker.
        let noise = if count < 12 { median.max(6.0) } else { median };
        let slow = self.config.slow_share * degrees(self.slow);
        Speeds {
            now: degrees(velocity - self.slow),
            high: self.config.high[0] + self.config.high[1] * noise + slow,
            low: self.config.low[0] + self.config.low[1] * noise + slow,
        }
    }

    fn follow_slow(&mut self, velocity: DVec3, interval: f64) {
        if matches!(self.phase, Phase::Settle { .. }) || self.rise.onset.is_some() {
            return;
        }
        let share = interval / (interval + self.config.slow_memory.0);
        self.slow += (velocity - self.slow) * share;
    }

    /// Watches a resting eye for a saccade.
    fn rise(&mut self, interval: f64, time: Seconds, direction: DVec3, speeds: &Speeds) -> Phase {
        if speeds.now < speeds.low {
            self.rise = Rise::default();
            return Phase::Rest;
        }
        // What the window holds moved in its middle, and began to from its oldest sample.
        let (oldest, from) = self.window.oldest();
        let middle = Seconds(0.5 * (oldest + time.0));
        let (onset, from) = *self.rise.onset.get_or_insert((middle, from));
        if speeds.now <= speeds.high {
            self.rise.above_high = 0;
            return Phase::Rest;
        }
        self.rise.above_high += 1;
        if self.rise.above_high < self.config.confirm && interval < self.config.sparse.0 {
            return Phase::Rest;
        }
        self.rise = Rise::default();
        let running = RunningSaccade {
            onset,
            found: time,
            from,
            now: time,
            at: direction,
            speed_deg_per_s: speeds.now,
            peak_deg_per_s: speeds.now,
        };
        Phase::Saccade {
            running,
            valley: f64::MAX,
        }
    }

    /// Follows a saccade, until it ends.
    fn go_on(&mut self, running: RunningSaccade, valley: f64, speeds: &Speeds) -> Phase {
        let peak = running.peak_deg_per_s;
        let valley = if speeds.now < self.config.valley * peak {
            valley.min(speeds.now)
        } else {
            valley
        };
        let rises_again = speeds.now > 1.1 * valley;
        let over_long = running.now.0 - running.onset.0 > self.config.longest.0;
        let young = running.now.0 - running.found.0 < self.config.shortest.0;
        if !young && (speeds.now < speeds.low || rises_again || over_long) {
            Phase::Settle { end: running.now }
        } else {
            Phase::Saccade { running, valley }
        }
    }
}

fn degrees(velocity: DVec3) -> f64 {
    Radians(velocity.length()).to_degrees()
}

#[cfg(test)]
mod tests;
