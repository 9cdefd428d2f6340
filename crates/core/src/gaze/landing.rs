//! Where will a running saccade land?
//!
//! Along its motion so far, as far as a linear rule says from how far it has come, how fast it is
//! and was, and for how long. Saccades are ballistic: 20 ms after it was found, one of 13° has half
//! its way before it, but its speed shows how much.

use super::saccade::RunningSaccade;
use crate::units::{Radians, Seconds};
use crate::view::axes::angle_between;
use glam::DVec3;

/// How long after a saccade was found its landing is worth using: before, a prediction is off by a
/// third of the saccade or more.
pub const USEFUL_AFTER: Seconds = Seconds(0.020);

/// Amplitude in degrees = sum of these x [way in degrees, speed (degrees per second), way x share,
/// milliseconds since the onset x speed / 100, speed x share, speed squared / 1000], where share is
/// speed / fastest speed.
///
/// Fitted by least absolute deviation on the saccades of 0.3–30° of one person, EyeLink 1000
/// (lookAtPoint of Zemblys et al. 2018), and with a fifth of their weight on saccades of the main
/// sequence at 250 and 1000 Hz, at every sample of 60 ms after they were found.
const RULE: [f64; 6] = [
    1.049_654,
    0.003_773_83,
    0.132_539,
    -0.044_858_4,
    0.000_565_668,
    0.044_119_6,
];
/// The rule holds up to about this many milliseconds after the onset.
const RULE_MS: f64 = 60.0;
/// People make no larger saccades without the head, in degrees.
const LARGEST_DEG: f64 = 40.0;
/// Share of the amplitude that the landing is off by (root mean square) x milliseconds since the
/// onset: 0.35 after 16 ms, 0.19 after 30, as measured with the fit.
const SPREAD_SHARE_MS: f64 = 5.6;
/// Least spread in degrees: eyes miss small targets by so much.
const LEAST_SPREAD_DEG: f64 = 0.3;

/// Where a saccade will land.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Unit direction, in the space of the saccade.
    pub direction: DVec3,
    /// One standard deviation of it.
    pub spread: Radians,
}

/// Predicts where a saccade will land: never short of where it is, never further than 40° from
/// where it began. Costs some hundred nanoseconds.
#[must_use]
pub fn predict_landing(saccade: &RunningSaccade) -> Landing {
    let elapsed_ms = ((saccade.now.0 - saccade.onset.0) * 1e3).clamp(1.0, RULE_MS);
    let way = angle_between(saccade.from, saccade.at);
    let way_deg = way.to_degrees();
    let speed = saccade.speed_deg_per_s;
    let share = speed / saccade.peak_deg_per_s.max(speed).max(1.0);
    let terms = [
        way_deg,
        speed,
        way_deg * share,
        elapsed_ms * speed / 100.0,
        speed * share,
        speed * speed / 1000.0,
    ];
    let ruled: f64 = RULE
        .iter()
        .zip(terms)
        .map(|(weight, term)| weight * term)
        .sum();
    let amplitude_deg = ruled.min(LARGEST_DEG).max(way_deg);
    let unsure = (SPREAD_SHARE_MS / elapsed_ms).min(1.0);
    Landing {
        direction: further(
            saccade.from,
            saccade.at,
            Radians::from_degrees(amplitude_deg),
        ),
        spread: Radians::from_degrees((unsure * amplitude_deg).max(LEAST_SPREAD_DEG)),
    }
}

/// The direction `angle` from `from` along the great circle through `through`; `through` where the
/// two coincide, which leaves the circle open.
fn further(from: DVec3, through: DVec3, angle: Radians) -> DVec3 {
    let across = through - from * from.dot(through);
    if across.length_squared() < 1e-18 {
        return through;
    }
    from * libm::cos(angle.0) + across.normalize() * libm::sin(angle.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::main_sequence::{saccade_duration, saccade_way};
    use crate::gaze::saccade::SaccadeDetector;
    use crate::gaze::sample::EyeEvent;
    use crate::view::axes::direction_from_yaw_pitch;

    /// Feeds a saccade of the main sequence to a detector; gives what it says at each sample.
    fn saccade(degrees: f64, rate_hz: f64) -> (Vec<RunningSaccade>, DVec3) {
        let amplitude = Radians::from_degrees(degrees);
        let length = saccade_duration(amplitude).0;
        let at = |t: f64| {
            let way = saccade_way(amplitude, (t - 0.5) / length);
            direction_from_yaw_pitch(Radians(amplitude.0 * way), Radians(0.1))
        };
        let mut detector = SaccadeDetector::default();
        let times = (0..)
            .map(|k| f64::from(k) / rate_hz)
            .take_while(|&t| t < 0.8);
        let found = times
            .filter_map(|t| detector.next(Seconds(t), at(t), true).saccade)
            .collect();
        (found, at(1.0))
    }

    #[test]
    fn from_20_ms_on_landings_are_nearer_than_the_samples_at_every_rate() {
        for rate_hz in [120.0, 250.0, 500.0, 1000.0] {
            let (mut off, mut left, mut sure) = (0.0, 0.0, 0.0);
            for degrees in [6.0, 10.0, 13.0, 16.0, 20.0, 24.0] {
                let (found, target) = saccade(degrees, rate_hz);
                let since = |s: &&RunningSaccade| s.now.0 - s.found.0;
                let then = |s: &&RunningSaccade| (USEFUL_AFTER.0..0.030).contains(&since(s));
                for running in found.iter().filter(then) {
                    let landing = predict_landing(running);
                    off += angle_between(landing.direction, target).0;
                    left += angle_between(running.at, target).0;
                    sure += landing.spread.0;
                }
            }
            assert!(off < 0.8 * left, "{off} of {left} at {rate_hz} Hz");
            assert!(
                off < 1.5 * sure,
                "{off} with a spread of {sure} at {rate_hz} Hz"
            );
        }
    }

    #[test]
    fn a_landing_grows_surer_and_never_lies_behind_the_eye() {
        let (found, _) = saccade(12.0, 1000.0);
        assert!(found.len() > 20);
        for pair in found.windows(2) {
            let [a, b] = [0, 1].map(|k| predict_landing(&pair[k]));
            let share =
                |l: &Landing, s: &RunningSaccade| l.spread.0 / angle_between(s.from, l.direction).0;
            assert!(share(&b, &pair[1]) <= share(&a, &pair[0]) + 1e-9);
            let reached = angle_between(pair[0].from, pair[0].at).0;
            assert!(angle_between(pair[0].from, a.direction).0 >= reached - 1e-9);
            assert!((a.direction.length() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn impossible_speeds_give_a_landing_within_reach() {
        let (found, _) = saccade(12.0, 1000.0);
        let wild = RunningSaccade {
            speed_deg_per_s: 9e9,
            peak_deg_per_s: 9e9,
            ..found[5]
        };
        let landing = predict_landing(&wild);
        assert!(angle_between(wild.from, landing.direction).to_degrees() < 40.0 + 1e-6);
        let still = RunningSaccade {
            at: wild.from,
            ..wild
        };
        assert_eq!(predict_landing(&still).direction, wild.from);
    }

    #[test]
    fn no_saccade_no_landing() {
        let mut detector = SaccadeDetector::default();
        let said = detector.next(Seconds(0.0), DVec3::X, true);
        assert_eq!((said.event, said.saccade), (EyeEvent::Fixation, None));
    }
}
