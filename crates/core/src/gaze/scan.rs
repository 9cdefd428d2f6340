//! Where would an eye wander that nobody recorded?
//!
//! Fixations of 300 ms joined by saccades of 5–15° to anywhere on the content: harder on a
//! streaming system than most recordings, and the same for everyone who gives the same seed.

use super::sample::GazeSample;
use crate::units::{Radians, Seconds};
use crate::view::axes::{angle_between, direction_at, direction_between};
use crate::view::random::Random;
use crate::view::surface::{Projection, Surface};
use glam::DVec3;

/// Length of a fixation in seconds.
const FIXATION_S: f64 = 0.3;
/// Range of saccade amplitudes in degrees.
const AMPLITUDE_DEG: [f64; 2] = [5.0, 15.0];
/// Main sequence of saccades: duration = 2.2 ms/° x amplitude + 21 ms (Carpenter 1988).
const SACCADE_S: [f64; 2] = [0.021, 0.0022];
/// Share of flat content's half size that fixations stay within.
const INSIDE: f64 = 0.95;
/// Tries to find a saccade that stays on the content before the eye returns to its centre.
const TRIES: u32 = 64;

/// A scan path: fixations and the saccades between them.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanPath {
    /// Start of each fixation in seconds, and where it looks.
    fixations: Vec<(f64, DVec3)>,
}

impl ScanPath {
    /// The path of a seed over a surface, at least `length` long; it begins at the content's
    /// forward.
    #[must_use]
    pub fn new(surface: &Surface, seed: u64, length: Seconds) -> Self {
        let mut random = Random::new(seed);
        let mut fixations = vec![(0.0, DVec3::NEG_Z)];
        let (mut time, mut at) = fixations[0];
        while time <= length.0 {
            let next = next_fixation(surface, &mut random, at);
            time += FIXATION_S + saccade_seconds(at, next);
            at = next;
            fixations.push((time, at));
        }
        Self { fixations }
    }

    /// The gaze at a time: a perfect eye, so the spread is 0. Returns also whether the eye is in a
    /// saccade.
    #[must_use]
    pub fn at(&self, time: Seconds) -> (GazeSample, bool) {
        let after = self
            .fixations
            .partition_point(|(start, _)| *start <= time.0);
        let (start, from) = self.fixations[after.saturating_sub(1)];
        let sample = |gaze_in_content| GazeSample {
            time,
            received: time,
            gaze_in_content,
            valid: true,
            spread: Radians(0.0),
            head: None,
        };
        let Some(&(landing, to)) = self.fixations.get(after) else {
            return (sample(from), false);
        };
        let moving = time.0 - start - FIXATION_S;
        if moving <= 0.0 {
            return (sample(from), false);
        }
        let share = moving / (landing - start - FIXATION_S);
        // Minimum-jerk profile (Flash and Hogan 1985).
        let eased = share * share * share * (10.0 - 15.0 * share + 6.0 * share * share);
        (sample(direction_between(from, to, eased)), true)
    }
}

fn saccade_seconds(from: DVec3, to: DVec3) -> f64 {
    SACCADE_S[0] + SACCADE_S[1] * angle_between(from, to).to_degrees()
}

fn next_fixation(surface: &Surface, random: &mut Random, from: DVec3) -> DVec3 {
    for _ in 0..TRIES {
        let bearing = Radians(2.0 * core::f64::consts::PI * random.unit());
        let amplitude = AMPLITUDE_DEG[0] + (AMPLITUDE_DEG[1] - AMPLITUDE_DEG[0]) * random.unit();
        let to = direction_at(from, bearing, Radians::from_degrees(amplitude));
        if is_on(surface, to) {
            return to;
        }
    }
    DVec3::NEG_Z
}

fn is_on(surface: &Surface, direction: DVec3) -> bool {
    surface.locate(direction).is_some_and(|(_, place)| {
        let tangent = surface.tangent(place);
        let inside = (0..2).all(|k| tangent[k].abs() <= INSIDE * surface.tangents[k]);
        surface.projection == Projection::Cube || inside
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::surface::Screen;

    #[test]
    fn saccades_are_5_to_15_degrees_and_stay_on_the_content() {
        let flat = Surface::flat([1920, 1080], Screen::default());
        for surface in [flat, Surface::cube(64)] {
            let path = ScanPath::new(&surface, 3, Seconds(60.0));
            for pair in path.fixations.windows(2) {
                let amplitude = angle_between(pair[0].1, pair[1].1).to_degrees();
                assert!(
                    (5.0 - 1e-9..=15.0 + 1e-9).contains(&amplitude),
                    "{amplitude}"
                );
                assert!(is_on(&surface, pair[1].1));
            }
        }
    }

    #[test]
    fn the_eye_rests_most_of_the_time_and_never_jumps() {
        let path = ScanPath::new(&Surface::cube(64), 5, Seconds(20.0));
        let samples: Vec<_> = (0..20_000)
            .map(|ms| path.at(Seconds(f64::from(ms) / 1e3)))
            .collect();
        let moving = samples.iter().filter(|(_, saccade)| *saccade).count();
        assert!(
            (1500..4000).contains(&moving),
            "{moving} of 20000 ms in saccades"
        );
        for pair in samples.windows(2) {
            let step = angle_between(pair[0].0.gaze_in_content, pair[1].0.gaze_in_content);
            assert!(step.to_degrees() < 0.7, "{step:?} in a millisecond");
        }
    }

    #[test]
    fn a_seed_gives_one_path() {
        let path = |seed| ScanPath::new(&Surface::cube(8), seed, Seconds(5.0));
        assert_eq!(path(1), path(1));
        assert_ne!(path(1), path(2));
    }
}
