//! Where would an eye wander, if no recording says?
//!
//! Fixations of 300 ms joined by saccades of 5–15° to anywhere on the content: harder on a
//! streaming system than most recordings, and the same for everyone who gives the same seed.

use super::sample::GazeSample;
use crate::units::{Radians, Seconds};
use crate::view::axes::{angle_between, direction_at, direction_between};
use crate::view::random::Random;
use crate::view::surface::Surface;
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

/// Length of a block in seconds. A path is made block by block, so that any time is reached in the
/// time of one.
const BLOCK_S: f64 = 600.0;

/// A scan path: fixations and the saccades between them. It has no end, and begins at the content's
/// forward, again every ten minutes.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanPath {
    surface: Surface,
    seed: u64,
    block: ScanBlock,
}

/// Ten minutes of a path.
#[derive(Clone, Debug, PartialEq)]
struct ScanBlock {
    number: u64,
    /// Start of each fixation in seconds from the block's, and where it looks.
    fixations: Vec<(f64, DVec3)>,
}

impl ScanBlock {
    /// The block of this number of the path of a seed.
    fn new(surface: &Surface, seed: u64, number: u64) -> Self {
        // Steps of a large odd number never meet before all numbers were met (Weyl's sequence).
        let mut random = Random::new(seed ^ number.wrapping_mul(0xd134_2543_de82_ef95));
        let mut fixations = vec![(0.0, first_fixation(surface))];
        let (mut time, mut at) = fixations[0];
        while time <= BLOCK_S {
            let next = next_fixation(surface, &mut random, at);
            time += FIXATION_S + saccade_seconds(at, next);
            at = next;
            fixations.push((time, at));
        }
        Self { number, fixations }
    }
}

impl ScanPath {
    /// The path of a seed over a surface.
    #[must_use]
    pub fn new(surface: &Surface, seed: u64) -> Self {
        Self {
            block: ScanBlock::new(surface, seed, 0),
            surface: *surface,
            seed,
        }
    }

    /// The gaze at a time: a perfect eye, so the spread is 0. Returns also whether the eye is in a
    /// saccade. The same for the same time, whatever was asked for before; a block of ten minutes
    /// is made in some milliseconds, the last one is kept.
    #[must_use]
    pub fn at(&mut self, time: Seconds) -> (GazeSample, bool) {
        // What is no time, or before the path, is its beginning.
        let number = (time.0 / BLOCK_S).max(0.0) as u64;
        if self.block.number != number {
            self.block = ScanBlock::new(&self.surface, self.seed, number);
        }
        let in_block = time.0 - number as f64 * BLOCK_S;
        let fixations = &self.block.fixations;
        let after = fixations.partition_point(|(start, _)| *start <= in_block);
        let (start, from) = fixations[after.saturating_sub(1)];
        let sample = |gaze_in_content| GazeSample {
            time,
            received: time,
            gaze_in_content,
            valid: true,
            spread: Radians(0.0),
            head: None,
        };
        let Some(&(landing, to)) = fixations.get(after) else {
            return (sample(from), false);
        };
        let moving = in_block - start - FIXATION_S;
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
    first_fixation(surface)
}

/// Straight ahead, or the middle of content that stands elsewhere.
fn first_fixation(surface: &Surface) -> DVec3 {
    match surface.slant {
        Some(_) => surface.direction(0, surface.size.map(|side| f64::from(side) / 2.0)),
        None => DVec3::NEG_Z,
    }
}

fn is_on(surface: &Surface, direction: DVec3) -> bool {
    surface.locate(direction).is_some_and(|(_, place)| {
        let (tangent, middle) = (surface.tangent(place), surface.middle());
        let within = |k: usize| (tangent[k] - middle[k]).abs() <= INSIDE * surface.tangents[k];
        let inside = (0..2).all(within);
        surface.projection.surrounds() || inside
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
            let path = ScanPath::new(&surface, 3);
            for pair in path.block.fixations.windows(2) {
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
        let mut path = ScanPath::new(&Surface::cube(64), 5);
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
        let path = |seed| ScanPath::new(&Surface::cube(8), seed);
        assert_eq!(path(1), path(1));
        assert_ne!(path(1), path(2));
    }

    #[test]
    fn any_time_is_reached_at_once_and_in_any_order() {
        let times = [
            3.0,
            599.9,
            600.0,
            1234.5,
            86_400.0 * 365.0,
            9.2e9,
            1e300,
            -5.0,
            f64::NAN,
        ];
        let path = || ScanPath::new(&Surface::cube(64), 9);
        let gaze = |path: &mut ScanPath, time: f64| path.at(Seconds(time)).0.gaze_in_content;
        let mut forward = path();
        let there: Vec<DVec3> = times.iter().map(|time| gaze(&mut forward, *time)).collect();
        for (time, expected) in times.iter().zip(&there).rev() {
            assert_eq!(gaze(&mut forward, *time), *expected, "{time}");
            assert_eq!(gaze(&mut path(), *time), *expected, "{time}");
        }
        // Each block begins at the content's forward, and goes on in its own way.
        let [first, second] = [0.0, 600.0].map(|from| [0.1, 5.0].map(|time| from + time));
        let looks = |times: [f64; 2]| times.map(|time| gaze(&mut path(), time));
        assert_eq!(looks(first)[0], DVec3::NEG_Z);
        assert_eq!(looks(second)[0], DVec3::NEG_Z);
        assert_ne!(looks(first)[1], looks(second)[1]);
    }
}
