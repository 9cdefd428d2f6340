//! Which samples do the published rules of velocity take for saccades?
//!
//! Both look at a whole trial, also at what comes after a sample: no rule for a viewer who watches
//! now, but the ones that results are usually compared with. Sources: docs/papers.md, rows
//! "saccades".

use super::events::runs;
use super::recording::Trial;
use foveal_core::gaze::sample::GazeSample;
use foveal_core::view::axes::yaw_pitch_from_direction;

/// Threshold of Engbert and Kliegl 2003, in medians of the velocity's deviation.
const LAMBDA: f64 = 6.0;
/// Shortest saccade of that rule, in seconds: three samples at the 500 Hz of Engbert and
/// Mergenthaler 2006, six at 1000 Hz.
const SHORTEST_S: f64 = 0.006;
/// Threshold of I-VT, in degrees per second.
const IVT_DEG_PER_S: f64 = 30.0;
/// Time that the velocity of I-VT is measured over, in seconds (Olsen 2012).
const IVT_WINDOW_S: f64 = 0.020;

/// Engbert and Kliegl 2003: samples whose velocity over five samples leaves the ellipse of six
/// median-based deviations of either axis, for at least 6 ms.
#[must_use]
pub fn engbert_kliegl(trial: &Trial) -> Vec<bool> {
    let velocities = velocities(trial, 1);
    let radii = [0, 1].map(|axis| {
        let known = velocities.iter().flatten().map(|velocity| velocity[axis]);
        LAMBDA * deviation(known.collect())
    });
    let leaves = |velocity: &Option<[f64; 2]>| {
        velocity.is_some_and(|velocity| {
            let share = [0, 1].map(|axis| velocity[axis] / radii[axis].max(f64::MIN_POSITIVE));
            share[0] * share[0] + share[1] * share[1] > 1.0
        })
    };
    let outside: Vec<bool> = velocities.iter().map(leaves).collect();
    let shortest = (SHORTEST_S * trial.rate_hz).round().max(1.0) as usize;
    let mut inside = vec![false; outside.len()];
    for run in runs(&outside)
        .into_iter()
        .filter(|run| run.len() >= shortest)
    {
        inside[run].fill(true);
    }
    inside
}

/// I-VT (Salvucci and Goldberg 2000): samples whose velocity over 20 ms is above 30° a second.
#[must_use]
pub fn ivt_30(trial: &Trial) -> Vec<bool> {
    let apart = (IVT_WINDOW_S / 4.0 * trial.rate_hz).round().max(1.0) as usize;
    let is_fast = |velocity: &Option<[f64; 2]>| {
        velocity.is_some_and(|[x, y]| x * x + y * y > IVT_DEG_PER_S * IVT_DEG_PER_S)
    };
    velocities(trial, apart).iter().map(is_fast).collect()
}

/// Velocity to the right and up at every sample, in degrees a second, from five samples that lie
/// `apart` of each other (Engbert and Kliegl 2003, Eq. 1); `None` where one of those between is
/// missing or not valid.
fn velocities(trial: &Trial, apart: usize) -> Vec<Option<[f64; 2]>> {
    let degrees = |sample: &GazeSample| {
        let (yaw, pitch) = yaw_pitch_from_direction(sample.gaze_in_content);
        sample.valid.then(|| [yaw.to_degrees(), pitch.to_degrees()])
    };
    let places: Vec<Option<[f64; 2]>> = trial.samples.iter().map(degrees).collect();
    let seconds = 6.0 * apart as f64 / trial.rate_hz;
    let velocity = |at: usize| {
        let (first, last) = (at.checked_sub(2 * apart)?, at + 2 * apart);
        let around = places.get(first..=last)?;
        if around.iter().any(Option::is_none) {
            return None;
        }
        let place = |k: usize| around[k * apart].unwrap_or_default();
        let [a, b, d, e] = [0, 1, 3, 4].map(place);
        Some([0, 1].map(|axis| (e[axis] + d[axis] - b[axis] - a[axis]) / seconds))
    };
    (0..places.len()).map(velocity).collect()
}

/// Square root of the median square less the squared median (Engbert and Kliegl 2003, Eq. 2).
fn deviation(values: Vec<f64>) -> f64 {
    let squares = values.iter().map(|value| value * value).collect();
    let middle = median(values);
    (median(squares) - middle * middle).max(0.0).sqrt()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() {
        0 => 0.0,
        even if even.is_multiple_of(2) => 0.5 * (values[half - 1] + values[half]),
        _ => values[half],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_core::units::{Radians, Seconds};

    /// A trial at 500 Hz whose yaw is given for every sample; `None` is not valid.
    fn trial(yaw_deg: impl Fn(usize) -> Option<f64>) -> Trial {
        let sample = |k: usize| {
            let yaw = Radians::from_degrees(yaw_deg(k).unwrap_or_default());
            // Pitch trembles too: an axis without any deviation has no threshold.
            let pitch = Radians::from_degrees(0.002 * (k as f64 * 1.7).sin());
            GazeSample {
                valid: yaw_deg(k).is_some(),
                ..GazeSample::at(Seconds(k as f64 / 500.0), yaw, pitch)
            }
        };
        Trial {
            rate_hz: 500.0,
            samples: (0..400).map(sample).collect(),
            labels: Vec::new(),
        }
    }

    /// A trembling eye that goes 5° to the right within 30 ms, from sample 200.
    fn jump(k: usize) -> f64 {
        0.002 * (k as f64 * 2.3).sin() + 5.0 * ((k as f64 - 200.0) / 15.0).clamp(0.0, 1.0)
    }

    #[test]
    fn both_rules_find_a_jump_where_it_is_and_nothing_else() {
        let trial = trial(|k| Some(jump(k)));
        for found in [engbert_kliegl(&trial), ivt_30(&trial)] {
            let events = runs(&found);
            assert_eq!(events.len(), 1, "{events:?}");
            let event = &events[0];
            assert!((195..=202).contains(&event.start), "{event:?}");
            assert!((213..=221).contains(&event.end), "{event:?}");
        }
    }

    #[test]
    fn the_velocity_of_an_even_turn_is_its_speed_at_any_spacing() {
        let trial = trial(|k| Some(k as f64 * 0.02));
        for apart in [1, 2, 5] {
            let found = velocities(&trial, apart);
            assert!(found[..2 * apart].iter().all(Option::is_none));
            for velocity in found[2 * apart..400 - 2 * apart].iter().flatten() {
                assert!((velocity[0] - 10.0).abs() < 1e-9, "{velocity:?}");
            }
        }
    }

    #[test]
    fn nothing_is_said_beside_a_sample_that_is_not_valid() {
        let trial = trial(|k| (k != 205).then(|| jump(k)));
        let found = engbert_kliegl(&trial);
        assert!(!found[203..=207].iter().any(|inside| *inside));
        let blind = self::trial(|_| None);
        assert!(!engbert_kliegl(&blind).contains(&true) && !ivt_30(&blind).contains(&true));
    }

    #[test]
    fn a_median_lies_between_the_middle_two() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(deviation(Vec::new()), 0.0);
    }
}
