//! How is a labelled recording synthesised?
//!
//! Fixations with drift, pursuit, saccades of the main sequence with their swing after landing,
//! blinks whose lids drag the gaze while the tracker still calls it valid, and white noise, from a
//! seed and at any rate.

use super::recording::{Label, Recording, Trial};
use foveal_core::gaze::main_sequence::{saccade_duration, saccade_way};
use foveal_core::gaze::sample::GazeSample;
use foveal_core::units::{Radians, Seconds};
use foveal_core::view::random::Random;

/// What is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SyntheticConfig {
    /// Samples per second.
    pub rate_hz: f64,
    /// Length in seconds.
    pub seconds: f64,
    /// Noise: root mean square of the distance from sample to sample, in degrees.
    pub noise_rms_deg: f64,
    /// Fastest pursuit; 0 for an eye that only fixates, in degrees per second.
    pub pursuit_deg_per_s: f64,
    /// Blinks.
    pub blinks_per_minute: f64,
    /// Where the random numbers begin.
    pub seed: u64,
}

impl Default for SyntheticConfig {
    fn default() -> Self {
        Self {
            rate_hz: 500.0,
            seconds: 120.0,
            noise_rms_deg: 0.03,
            pursuit_deg_per_s: 0.0,
            blinks_per_minute: 12.0,
            seed: 1,
        }
    }
}

/// Shortest and longest fixation in seconds.
const FIXATION_S: [f64; 2] = [0.15, 0.6];
/// Smallest and largest saccade in degrees; their logarithms are uniform.
const AMPLITUDE_DEG: [f64; 2] = [0.7, 20.0];
/// The gaze stays about within this of straight ahead, in degrees.
const FIELD_DEG: f64 = 12.0;
/// Speed of fixational drift in degrees per second.
const DRIFT_DEG_PER_S: f64 = 0.4;
/// Time in which pursuit comes up to speed, in seconds.
const PURSUIT_RISE_S: f64 = 0.1;
/// The swing after a saccade: share of its amplitude, at most (degrees), its rate and its decay
/// in seconds, and how long it is labelled.
const SWING: (f64, f64, f64, f64, f64) = (0.06, 0.6, 22.0, 0.012, 0.025);
/// A blink: how long the lid drags the gaze before and after the loss, and shortest and longest
/// loss, in seconds.
const BLINK_S: (f64, f64, [f64; 2]) = (0.03, 0.08, [0.08, 0.25]);
/// How far the lid drags it, in degrees.
const DRAG_DEG: f64 = 6.0;

/// Makes a recording of one trial and one coder, `truth`.
#[must_use]
pub fn synthetic_recording(config: &SyntheticConfig) -> Recording {
    let mut maker = Maker {
        config: *config,
        random: Random::new(config.seed),
        trial: Trial {
            rate_hz: config.rate_hz,
            samples: Vec::new(),
            labels: vec![Vec::new()],
        },
        now: 0.0,
        at: [0.0; 2],
        from: [0.0; 2],
        velocity: [0.0; 2],
        swing: None,
    };
    while maker.now < config.seconds {
        maker.fixate();
        maker.jump();
    }
    Recording {
        name: format!(
            "synthetic {} Hz, noise {} deg, pursuit {} deg/s",
            config.rate_hz, config.noise_rms_deg, config.pursuit_deg_per_s
        ),
        coders: vec!["truth".to_owned()],
        trials: vec![maker.trial],
    }
}

struct Maker {
    config: SyntheticConfig,
    random: Random,
    trial: Trial,
    /// End of what has been made, in seconds.
    now: f64,
    /// Where the eye is, in degrees right and up.
    at: [f64; 2],
    /// Velocity before and after the last change, in degrees per second.
    from: [f64; 2],
    velocity: [f64; 2],
    /// End of the last saccade and its swing in degrees.
    swing: Option<(f64, [f64; 2])>,
}

impl Maker {
    fn between(&mut self, [least, most]: [f64; 2]) -> f64 {
        least + (most - least) * self.random.unit()
    }

    /// A fixation or pursuit, perhaps with a blink in it.
    fn fixate(&mut self) {
        let length = self.between(FIXATION_S);
        let pursues = self.config.pursuit_deg_per_s > 0.0 && self.random.unit() < 0.7;
        let speed = if pursues {
            self.config.pursuit_deg_per_s * self.random.unit()
        } else {
            DRIFT_DEG_PER_S
        };
        self.from = self.velocity;
        self.velocity = self.heading(speed);
        let label = if pursues {
            Label::Pursuit
        } else {
            Label::Fixation
        };
        let start = self.now;
        self.make(length, |_, t| {
            let swings = start > 0.0 && t < SWING.4;
            (
                ([0.0; 2]),
                if swings { Label::Oscillation } else { label },
                true,
            )
        });
        if self.random.unit() * 60.0 < self.config.blinks_per_minute * length {
            self.blink();
            self.make(length, |_, _| ([0.0; 2], label, true));
        }
    }

    fn blink(&mut self) {
        let (before, after, range) = BLINK_S;
        let lost = self.between(range);
        self.make(before, |_, t| {
            ([0.0, -DRAG_DEG * t / before], Label::Blink, true)
        });
        self.make(lost, |_, _| ([0.0; 2], Label::Blink, false));
        self.make(after, |_, t| {
            ([0.0, -DRAG_DEG * (1.0 - t / after)], Label::Blink, true)
        });
    }

    /// A saccade of the main sequence.
    fn jump(&mut self) {
        let log = self.between(AMPLITUDE_DEG.map(f64::ln));
        let amplitude = log.exp();
        let to = self.heading(amplitude);
        let angle = Radians::from_degrees(amplitude);
        let length = saccade_duration(angle).0;
        self.make(length, |_, t| {
            let way = saccade_way(angle, t / length);
            (to.map(|a| a * way), Label::Saccade, true)
        });
        let size = (SWING.0 * amplitude).min(SWING.1) / amplitude;
        self.at = [self.at[0] + to[0], self.at[1] + to[1]];
        self.swing = Some((self.now, to.map(|a| a * size)));
    }

    /// A vector of a length that leads about to the middle of the field when outside it.
    fn heading(&mut self, length: f64) -> [f64; 2] {
        let [x, y] = self.at;
        let outside = x * x + y * y > FIELD_DEG * FIELD_DEG;
        let spread = if outside {
            1.0
        } else {
            2.0 * std::f64::consts::PI
        };
        let angle = (-y).atan2(-x) + spread * (self.random.unit() - 0.5);
        [length * angle.cos(), length * angle.sin()]
    }

    /// Appends `length` seconds; `offset` gives, of the maker and the time within, what is added
    /// to the gaze, the label, and whether the tracker sees it.
    fn make(&mut self, length: f64, offset: impl Fn(&Self, f64) -> ([f64; 2], Label, bool)) {
        let (start, step) = (self.now, 1.0 / self.config.rate_hz);
        self.now += length;
        loop {
            let time = self.trial.samples.len() as f64 * step;
            if time >= self.now {
                return;
            }
            let (added, label, valid) = offset(self, time - start);
            let gaze = self.gaze(time, step, start, label);
            let degrees = [0, 1].map(|k| Radians::from_degrees(gaze[k] + added[k]));
            let sample = GazeSample::at(Seconds(time), degrees[0], degrees[1]);
            self.trial.samples.push(GazeSample { valid, ..sample });
            self.trial.labels[0].push(label);
        }
    }

    /// The eye with its slow movement, swing and noise, before any offset.
    fn gaze(&mut self, time: f64, step: f64, start: f64, label: Label) -> [f64; 2] {
        let share = ((time - start) / PURSUIT_RISE_S).min(1.0);
        let swing = self.swing.map_or([0.0; 2], |(end, swing)| {
            let (t, turn) = (time - end, 2.0 * std::f64::consts::PI * SWING.2);
            swing.map(|a| a * (turn * t).sin() * (-t / SWING.3).exp())
        });
        // Two dimensions of white noise, each step the difference of two: rms = 2 sigma.
        let sigma = self.config.noise_rms_deg / 2.0;
        [0, 1].map(|k| {
            let slow = match label {
                Label::Saccade => self.velocity[k],
                _ => self.from[k] + (self.velocity[k] - self.from[k]) * share,
            };
            self.at[k] += slow * step;
            self.at[k] + swing[k] + sigma * self.normal()
        })
    }

    /// A standard normal number (Box and Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.random.unit()).ln()).sqrt();
        radius * (2.0 * std::f64::consts::PI * self.random.unit()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::view::axes::angle_between;

    #[test]
    fn noise_has_the_strength_that_was_asked_for() {
        let config = SyntheticConfig {
            noise_rms_deg: 0.08,
            ..SyntheticConfig::default()
        };
        let trial = synthetic_recording(&config).trials.remove(0);
        let still = |k: &usize| trial.labels[0][*k..*k + 2] == [Label::Fixation; 2];
        let pairs = (0..trial.samples.len() - 1).filter(still);
        let squares: Vec<f64> = pairs
            .map(|k| {
                let [a, b] = [k, k + 1].map(|k| trial.samples[k].gaze_in_content);
                angle_between(a, b).to_degrees().powi(2)
            })
            .collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!((rms - 0.08).abs() < 0.004, "{rms}");
    }

    #[test]
    fn a_recording_has_its_length_its_labels_and_its_gaps_and_a_seed_gives_one() {
        let config = SyntheticConfig {
            rate_hz: 90.0,
            ..SyntheticConfig::default()
        };
        let recording = synthetic_recording(&config);
        let trial = &recording.trials[0];
        assert!(trial.samples.len() as f64 >= 90.0 * 120.0);
        assert_eq!(trial.labels[0].len(), trial.samples.len());
        let lost = trial
            .samples
            .iter()
            .zip(&trial.labels[0])
            .filter(|(s, _)| !s.valid);
        assert!(lost.clone().count() > 90 && lost.clone().all(|(_, &l)| l == Label::Blink));
        assert!(
            trial
                .samples
                .windows(2)
                .all(|pair| pair[0].time < pair[1].time)
        );
        assert_eq!(recording, synthetic_recording(&config));
        assert_ne!(
            recording,
            synthetic_recording(&SyntheticConfig { seed: 2, ..config })
        );
    }
}
