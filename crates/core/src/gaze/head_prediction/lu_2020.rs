//! Where would the memoryless variant of the linear eye-head model put the gaze?
//!
//! Lu et al. 2020, Algorithm 1, which follows Hu et al. 2019 in its equations and regions. The one
//! difference to [`super::sgaze`]: in the static *and* in the sudden region the result is one mean
//! gaze (`meanX`, `meanY`, an input named for the static region), so a sudden move forgets where
//! the eyes were instead of keeping the mean of the last 600 ms. The paper prints no numbers;
//! thresholds and coefficients are those of Hu et al. 2019, and no salient place is read.

use super::gaze_in_head::GazeInHead;
use super::motion::SgazeMotion;
use super::sgaze::{Region, STATIC_GAZE_DEG, intentional_deg, region};

/// The gaze for the head of one sample: Lu et al. 2020, Algorithm 1. Each axis is decided by
/// itself.
#[must_use]
pub fn predict_lu_2020(head: &SgazeMotion) -> GazeInHead {
    let head = SgazeMotion {
        salient_deg: None,
        ..*head
    };
    GazeInHead::within_reach([0, 1].map(|axis| {
        match region(axis, head.motion.velocity_deg_s[axis]) {
            Region::Static | Region::Sudden => STATIC_GAZE_DEG[axis],
            Region::Intentional => intentional_deg(axis, &head),
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::head_prediction::HeadMotion;
    use crate::gaze::head_prediction::sgaze::Sgaze;
    use crate::units::Seconds;

    fn at(time: f64, velocity_deg_s: [f64; 2]) -> SgazeMotion {
        SgazeMotion {
            motion: HeadMotion {
                time: Seconds(time),
                velocity_deg_s,
                mean_acceleration_deg_s2: [12.0, -7.0],
            },
            ..SgazeMotion::default()
        }
    }

    #[test]
    fn it_differs_from_sgaze_in_sudden_moves_only() {
        let mut sgaze = Sgaze::default();
        for k in 0..400 {
            let yaw = f64::from(k % 200) - 100.0;
            let head = at(f64::from(k) * 0.01, [yaw, 0.3 * yaw]);
            let (theirs, ours) = (sgaze.predict(&head), predict_lu_2020(&head));
            let is_sudden = !(-88.5..=83.8).contains(&yaw);
            if is_sudden {
                assert_eq!(ours.yaw_deg, STATIC_GAZE_DEG[0]);
            } else {
                assert_eq!(ours, theirs, "{yaw}");
            }
        }
        let after_a_turn = sgaze.predict(&at(4.0, [120.0, 0.0]));
        assert!((after_a_turn.yaw_deg - STATIC_GAZE_DEG[0]).abs() > 1.0);
    }
}
