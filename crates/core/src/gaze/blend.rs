//! How much is a late gaze still worth, compared with what the head says?
//!
//! The last tracked gaze is true until the eye jumps; the head's prediction is never close and
//! never far. What is shown later than about 75 ms after the last gaze lies best between them.

use super::head_prediction::GazeInHead;
use crate::gaze::table::between;
use crate::units::Seconds;

/// Weight of the last gaze by its age in seconds: the best in steps of 0.1 on recordings of Hu et
/// al. 2019, 100 Hz, free viewing.
const WEIGHTS: [(f64, f64); 9] = [
    (0.05, 1.0),
    (0.1, 0.9),
    (0.15, 0.8),
    (0.2, 0.7),
    (0.3, 0.5),
    (0.4, 0.4),
    (0.5, 0.3),
    (1.0, 0.1),
    (2.0, 0.0),
];

/// Weight in [0, 1] of the last tracked gaze when it is `age` old, linear between measured ages.
#[must_use]
pub fn last_gaze_weight(age: Seconds) -> f64 {
    between(&WEIGHTS, age.0)
}

/// Where to expect the eyes, from where they were `age` ago and from what the head says; both in
/// the head, along straight lines on the tangent screen.
#[must_use]
pub fn blend(last: GazeInHead, head: GazeInHead, age: Seconds) -> GazeInHead {
    let weight = last_gaze_weight(age);
    let [a, b] = [last.degrees(), head.degrees()];
    GazeInHead::within_reach([0, 1].map(|k| weight * a[k] + (1.0 - weight) * b[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_gaze_never_counts_more_than_an_early_one() {
        let weights: Vec<f64> = (0..300)
            .map(|k| last_gaze_weight(Seconds(f64::from(k) * 0.01)))
            .collect();
        assert!(weights.windows(2).all(|pair| pair[1] <= pair[0]));
        assert_eq!((weights[0], weights[299]), (1.0, 0.0));
    }

    #[test]
    fn a_blend_begins_at_the_last_gaze_and_ends_at_the_head() {
        let [last, head] = [[10.0, -4.0], [-6.0, 2.0]].map(GazeInHead::within_reach);
        assert_eq!(blend(last, head, Seconds(0.02)), last);
        assert_eq!(blend(last, head, Seconds(5.0)), head);
        let middle = blend(last, head, Seconds(0.3));
        assert_eq!(middle.degrees(), [2.0, -1.0]);
    }
}
