//! Where would the published linear eye-head model put the gaze?
//!
//! Hu et al. 2019, *SGaze* (TVCG 25(5)), with the coefficients and thresholds that its authors
//! published as code; Lu et al. 2020 print its equations as their Eq. 1 (yaw) and 2 (pitch). A
//! baseline: each axis is in one of three regions by the head's speed. A head that turns
//! intentionally draws the gaze linearly; a still head does not; during a sudden move the gaze
//! stays at the mean of the predictions of the last 600 ms.

use super::gaze_in_head::GazeInHead;
use super::motion::SgazeMotion;

/// Mean gaze of the recordings that the model was made from, in degrees: its paper's own baseline.
pub const MEAN_GAZE_DEG: [f64; 2] = [0.03, -2.34];
/// Mean gaze while the head is still, in degrees.
pub const STATIC_GAZE_DEG: [f64; 2] = [-0.05, -1.83];

/// Below this speed an axis is still, in degrees per second.
const STATIC_DEG_S: [f64; 2] = [0.5, 0.2];
/// Outside of these velocities a move is sudden, in degrees per second.
const SUDDEN_DEG_S: [[f64; 2]; 2] = [[-88.5, 83.8], [-35.6, 36.0]];
/// Gaze per head velocity, in seconds, and its change with the velocity's deviation.
const SLOPE: [[f64; 2]; 2] = [[0.2491, -0.0015], [0.5293, -0.0053]];
/// How far ahead the velocity is taken, in seconds.
const LEAD_S: [f64; 2] = [0.1480, 0.0304];
/// Gaze per head acceleration, in seconds squared; the pitch has no such term.
const PER_ACCELERATION: f64 = 0.0006;
/// Share of the most salient place.
const PER_SALIENT: [f64; 2] = [0.0344, 0.0503];
/// Gaze at rest within the linear law, in degrees.
const OFFSET_DEG: [f64; 2] = [0.1777, -2.5249];
/// How long a prediction counts during a sudden move, in seconds.
const MEMORY_S: f64 = 0.6;
/// The rate that the model was made for, in hertz.
const RATE_HZ: f64 = 100.0;
const MEMORIES: usize = 60;

/// How an axis of the head moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Hardly at all.
    Static,
    /// As someone does who looks round.
    Intentional,
    /// Faster.
    Sudden,
}

/// The region of an axis (0 yaw, 1 pitch) by its velocity in degrees per second.
#[must_use]
pub fn region(axis: usize, velocity_deg_s: f64) -> Region {
    let [least, most] = SUDDEN_DEG_S[axis];
    if velocity_deg_s.abs() < STATIC_DEG_S[axis] {
        Region::Static
    } else if (least..=most).contains(&velocity_deg_s) {
        Region::Intentional
    } else {
        Region::Sudden
    }
}

/// Gaze along an axis, in degrees, while the head moves intentionally: Hu et al. 2019;
/// Lu et al. 2020, Eq. 1 (yaw) and 2 (pitch). Without a salient place, the centre counts.
#[must_use]
pub fn intentional_deg(axis: usize, head: &SgazeMotion) -> f64 {
    let [slope, by_deviation] = SLOPE[axis];
    let slope = slope + by_deviation * head.velocity_deviation_deg_s[axis];
    let velocity = head.motion.velocity_deg_s[axis]
        + LEAD_S[axis] * head.motion.mean_acceleration_deg_s2[axis];
    let acceleration = if axis == 0 {
        PER_ACCELERATION * head.yaw_acceleration_deg_s2
    } else {
        0.0
    };
    let salient = head.salient_deg.map_or(0.0, |place| place[axis]);
    slope * velocity + acceleration + PER_SALIENT[axis] * salient + OFFSET_DEG[axis]
}

/// The model with its memory of what it predicted. Fixed size; samples in the order of time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sgaze {
    axes: [RecentMean; 2],
}

impl Sgaze {
    /// The gaze for the head of one sample. Costs at most one look at 60 remembered predictions
    /// per axis.
    pub fn predict(&mut self, head: &SgazeMotion) -> GazeInHead {
        let time = head.motion.time.0;
        let mut gaze = [0.0; 2];
        for axis in 0..2 {
            gaze[axis] = match region(axis, head.motion.velocity_deg_s[axis]) {
                Region::Static => STATIC_GAZE_DEG[axis],
                Region::Intentional => intentional_deg(axis, head),
                Region::Sudden => self.axes[axis].mean(time).unwrap_or(STATIC_GAZE_DEG[axis]),
            };
            self.axes[axis].remember(time, gaze[axis]);
        }
        GazeInHead::within_reach(gaze)
    }
}

/// The mean of a value over the last 600 ms, kept at 100 Hz at most.
#[derive(Clone, Copy, Debug)]
struct RecentMean {
    kept: [(f64, f64); MEMORIES],
    next: usize,
}

impl Default for RecentMean {
    fn default() -> Self {
        Self {
            kept: [(f64::NEG_INFINITY, 0.0); MEMORIES],
            next: 0,
        }
    }
}

impl RecentMean {
    fn remember(&mut self, time: f64, value: f64) {
        let newest = self.kept[(self.next + MEMORIES - 1) % MEMORIES].0;
        // A little less than a step, so that 100 Hz with jitter keeps every value.
        if time - newest >= 0.95 / RATE_HZ {
            self.kept[self.next] = (time, value);
            self.next = (self.next + 1) % MEMORIES;
        }
    }

    fn mean(&self, time: f64) -> Option<f64> {
        let recent = |at: f64| time - at <= MEMORY_S + 0.5 / RATE_HZ;
        let (sum, count) = self
            .kept
            .iter()
            .filter(|(at, _)| recent(*at))
            .fold((0.0, 0u32), |(sum, count), (_, value)| {
                (sum + value, count + 1)
            });
        (count > 0).then(|| sum / f64::from(count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaze::head_prediction::HeadMotion;
    use crate::units::Seconds;

    fn at(time: f64, yaw: f64, pitch: f64) -> SgazeMotion {
        SgazeMotion {
            motion: HeadMotion {
                time: Seconds(time),
                velocity_deg_s: [yaw, pitch],
                mean_acceleration_deg_s2: [0.0; 2],
            },
            ..SgazeMotion::default()
        }
    }

    #[test]
    fn an_intentional_turn_has_the_value_of_the_published_equation() {
        let head = SgazeMotion {
            motion: HeadMotion {
                velocity_deg_s: [20.0, -10.0],
                mean_acceleration_deg_s2: [50.0, 30.0],
                ..HeadMotion::default()
            },
            yaw_acceleration_deg_s2: 40.0,
            velocity_deviation_deg_s: [25.0, 10.0],
            salient_deg: Some([10.0, -10.0]),
        };
        // (-0.0015 * 25 + 0.2491) (20 + 0.148 * 50) + 0.0006 * 40 + 0.0344 * 10 + 0.1777
        assert!((intentional_deg(0, &head) - 6.34354).abs() < 1e-9);
        // (-0.0053 * 10 + 0.5293) (-10 + 0.0304 * 30) + 0.0503 * -10 - 2.5249
        assert!((intentional_deg(1, &head) - -7.3565144).abs() < 1e-9);
    }

    #[test]
    fn axes_are_in_regions_of_their_own() {
        let mut model = Sgaze::default();
        let gaze = model.predict(&at(0.0, 0.4, 10.0));
        assert_eq!(gaze.yaw_deg, STATIC_GAZE_DEG[0]);
        assert!(gaze.pitch_deg > 2.0);
        let regions = [-90.0, -88.5, -0.5, 0.49, 83.8, 84.0].map(|v| region(0, v));
        use Region::{Intentional, Static, Sudden};
        let wanted = [
            Sudden,
            Intentional,
            Intentional,
            Static,
            Intentional,
            Sudden,
        ];
        assert_eq!(regions, wanted);
    }

    #[test]
    fn a_sudden_move_keeps_the_mean_of_the_last_600_ms_at_any_rate() {
        for rate in [60u32, 100, 1000] {
            let mut model = Sgaze::default();
            let time = |k: u32| f64::from(k) / f64::from(rate);
            let mut held = GazeInHead::CENTRE;
            for k in 0..=2 * rate {
                // Slow for 1.7 s, 40 deg/s for the last 0.3 s before the sudden move.
                let speed = if time(k) <= 1.7 { 0.0 } else { 40.0 };
                let speed = if k == 2 * rate { 120.0 } else { speed };
                held = model.predict(&at(time(k), speed, 0.0));
            }
            let half = (0.2491 * 40.0 + 0.1777 - 0.05) / 2.0;
            assert!((held.yaw_deg - half).abs() < 0.3, "{rate} Hz: {held:?}");
        }
    }

    #[test]
    fn a_sudden_move_with_no_past_looks_where_still_heads_do() {
        let gaze = Sgaze::default().predict(&at(0.0, 200.0, 90.0));
        assert_eq!(gaze.degrees(), STATIC_GAZE_DEG);
    }
}
