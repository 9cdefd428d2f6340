//! Where does the eye look while the tracker does not see it?
//!
//! The last gaze holds for a second and grows uncertain; then the head alone says where.

use super::sample::{GazeSample, HeadPose};
use crate::units::{Radians, Seconds};
use glam::DVec3;

/// How long the last gaze stands in for one that is not seen.
pub const HOLD: Seconds = Seconds(1.0);

/// Growth of the spread while the eye is lost, in degrees per second: after [`HOLD`] the last gaze
/// is about as uncertain as one guessed from the head.
const SPREAD_GROWTH_DEG_PER_S: f64 = 7.0;

/// Spread of a gaze known only from the head, in degrees: between the median (5.9°) and the 90th
/// percentile (13.5°) of what is left when gaze is predicted from head motion.
const HEAD_ONLY_SPREAD_DEG: f64 = 7.0;

/// Spread of a gaze of which nothing at all is known, in degrees: about how far eyes turn before
/// the head follows.
const WIDEST_SPREAD_DEG: f64 = 20.0;

/// Where the eye looks when only the head is known: unit direction in the content's space and
/// spread. The head's forward.
#[must_use]
pub fn head_only_gaze(head: HeadPose) -> (DVec3, Radians) {
    let spread = Radians::from_degrees(HEAD_ONLY_SPREAD_DEG);
    (head.axes().forward, spread)
}

/// The gaze at `time`, from the `newest` sample and the newest valid one, `seen`.
///
/// A valid newest sample stands. Otherwise `seen` holds with a growing spread; after [`HOLD`] the
/// newest head takes over ([`head_only_gaze`]), at once if no valid sample ever came. Where no
/// head is known, `seen` goes on holding, at most 20° uncertain. What stands in is not `valid`.
#[must_use]
pub fn gaze_at(time: Seconds, newest: &GazeSample, seen: Option<&GazeSample>) -> GazeSample {
    if newest.valid {
        return *newest;
    }
    let held = seen.filter(|seen| newest.head.is_none() || time.0 - seen.time.0 <= HOLD.0);
    let widest = Radians::from_degrees(WIDEST_SPREAD_DEG);
    let (gaze_in_content, spread) = match (held, newest.head) {
        (Some(seen), _) => {
            let lost_s = (time.0 - seen.time.0).max(0.0);
            let grown = seen.spread.0 + Radians::from_degrees(SPREAD_GROWTH_DEG_PER_S).0 * lost_s;
            let most = widest.0.max(seen.spread.0);
            (seen.gaze_in_content, Radians(grown.min(most)))
        }
        (None, Some(head)) => head_only_gaze(head),
        (None, None) => (newest.gaze_in_content, widest),
    };
    GazeSample {
        gaze_in_content,
        spread,
        ..*newest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::axes::angle_between;

    fn seen_at(yaw_deg: f64) -> GazeSample {
        GazeSample {
            spread: Radians::from_degrees(1.0),
            ..GazeSample::at(
                Seconds(10.0),
                Radians::from_degrees(yaw_deg),
                Radians::default(),
            )
        }
    }

    fn lost(head: Option<HeadPose>) -> GazeSample {
        GazeSample {
            time: Seconds(10.1),
            valid: false,
            head,
            ..seen_at(50.0)
        }
    }

    fn head() -> HeadPose {
        HeadPose {
            yaw: Radians::from_degrees(30.0),
            ..HeadPose::default()
        }
    }

    #[test]
    fn the_last_gaze_holds_for_a_second_with_a_growing_spread_then_the_head_takes_over() {
        let (seen, newest) = (seen_at(10.0), lost(Some(head())));
        let mut before = 0.0;
        for lost_s in [0.1, 0.4, 0.7, 1.0] {
            let gaze = gaze_at(Seconds(10.0 + lost_s), &newest, Some(&seen));
            assert_eq!(gaze.gaze_in_content, seen.gaze_in_content);
            assert!(gaze.spread.0 > before && !gaze.valid);
            before = gaze.spread.0;
        }
        let late = gaze_at(Seconds(11.001), &newest, Some(&seen));
        assert_eq!(late.gaze_in_content, head().axes().forward);
        assert!((late.spread.to_degrees() - 7.0).abs() < 1e-9 && !late.valid);
    }

    #[test]
    fn without_a_head_the_last_gaze_goes_on_and_its_spread_stays_bounded() {
        let seen = seen_at(10.0);
        let late = gaze_at(Seconds(1e9), &lost(None), Some(&seen));
        assert_eq!(late.gaze_in_content, seen.gaze_in_content);
        assert!((late.spread.to_degrees() - 20.0).abs() < 1e-9);
    }

    #[test]
    fn a_head_without_any_gaze_speaks_at_once() {
        let gaze = gaze_at(Seconds(0.0), &lost(Some(head())), None);
        let off = angle_between(gaze.gaze_in_content, head().axes().forward);
        assert!(off.0 < 1e-12);
        assert!(gaze_at(Seconds(0.0), &lost(None), None).spread.to_degrees() > 19.9);
    }

    #[test]
    fn a_valid_sample_stands_unchanged() {
        let seen = seen_at(10.0);
        assert_eq!(gaze_at(Seconds(99.0), &seen, Some(&seen)), seen);
    }
}
