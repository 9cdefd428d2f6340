//! How far ahead of a turning head do the eyes look?
//!
//! By a nearly constant angle as soon as the head turns at all, plus a little more as it turns
//! faster: per axis `gain tanh(u / scale) + linear u / 50 + offset`, where `u` is the head's
//! velocity a lead ahead of now. Linear models (Hu et al. 2019) miss the constant part.

use super::gaze_in_head::GazeInHead;
use super::motion::HeadMotion;
use crate::units::Radians;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Accelerations beyond this are noise of the sensor, in degrees per second squared.
pub const MOST_ACCELERATION_DEG_S2: f64 = 300.0;
/// The velocity at which the linear part is what the preset says, in degrees per second.
pub const LINEAR_AT_DEG_S: f64 = 50.0;

/// Spread of free viewing round its prediction, in degrees: measured where it was fitted.
pub(in crate::gaze) const FREE_VIEWING_SPREAD_DEG: f64 = 6.2;

/// How gaze follows the head along one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisCurve {
    /// How far ahead of a turning head the eyes are, in degrees.
    pub gain_deg: f64,
    /// Velocity at which three quarters of the gain are reached, in degrees per second.
    pub scale_deg_s: f64,
    /// What a head at 50 degrees per second adds, in degrees.
    pub linear_deg: f64,
    /// Gaze while the head is still, in degrees.
    pub offset_deg: f64,
    /// How far the velocity is looked ahead with the mean acceleration, in seconds.
    pub lead_s: f64,
}

/// A law by which gaze follows the head, for one kind of task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeadGazePreset {
    /// What the preset is for.
    pub name: String,
    /// One standard deviation of the eyes' direction round the prediction, along any axis.
    pub spread_deg: f64,
    /// To the right.
    pub yaw: AxisCurve,
    /// Up.
    pub pitch: AxisCurve,
}

/// Why numbers are no preset.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{field} is {found}; give {expected}")]
pub struct PresetError {
    /// Where the number stands.
    pub field: String,
    /// The number.
    pub found: f64,
    /// What it should be.
    pub expected: String,
}

impl AxisCurve {
    /// Range of each parameter, in the order of the fields. A curve outside of them follows noise.
    pub const RANGES: [(&'static str, [f64; 2]); 5] = [
        ("gain_deg", [0.0, 30.0]),
        ("scale_deg_s", [0.3, 100.0]),
        ("linear_deg", [-10.0, 30.0]),
        ("offset_deg", [-20.0, 20.0]),
        ("lead_s", [0.0, 0.5]),
    ];

    /// The parameters in the order of the fields.
    #[must_use]
    pub fn parameters(&self) -> [f64; 5] {
        [
            self.gain_deg,
            self.scale_deg_s,
            self.linear_deg,
            self.offset_deg,
            self.lead_s,
        ]
    }

    /// The velocity that the eyes answer to: `velocity + lead x mean acceleration`.
    #[must_use]
    pub fn drive(&self, motion: &HeadMotion, axis: usize) -> f64 {
        let acceleration = motion.mean_acceleration_deg_s2[axis];
        let most = MOST_ACCELERATION_DEG_S2;
        motion.velocity_deg_s[axis] + self.lead_s * acceleration.clamp(-most, most)
    }

    /// Gaze along this axis in degrees, for a drive in degrees per second.
    #[must_use]
    pub fn gaze_deg(&self, drive: f64) -> f64 {
        self.gain_deg * libm::tanh(drive / self.scale_deg_s)
            + self.linear_deg * drive / LINEAR_AT_DEG_S
            + self.offset_deg
    }
}

impl HeadGazePreset {
    /// Looking round freely, standing or walking. Fitted on eight recordings of Hu et al. 2019
    /// (scenes desert, forest and pub, 141,000 samples).
    ///
    /// Of the 1.42° that those viewers looked to the right on the whole, 0.45° are kept: the rest
    /// is the group's or its headset's. So their mirror images are predicted within 0.15° as well
    /// as they are, for 0.05° of their own error. A tracker gives each viewer their own offset
    /// ([`super::adaptive`]).
    #[must_use]
    pub fn free_viewing() -> Self {
        Self {
            name: "free-viewing".to_owned(),
            spread_deg: FREE_VIEWING_SPREAD_DEG,
            yaw: AxisCurve {
                gain_deg: 4.41,
                scale_deg_s: 1.221,
                linear_deg: 2.54,
                offset_deg: 0.45,
                lead_s: 0.102,
            },
            pitch: AxisCurve {
                gain_deg: 4.87,
                scale_deg_s: 0.758,
                linear_deg: 0.59,
                offset_deg: -2.10,
                lead_s: 0.070,
            },
        }
    }

    /// Searching for a target: the eyes lead less at once and farther when the head turns fast.
    /// Gain, scale and spread from a search for targets in VR (GazeBubble, one viewer, 206,000
    /// samples), the rest as in free viewing.
    #[must_use]
    pub fn search() -> Self {
        let free = Self::free_viewing();
        let wide = |curve: AxisCurve| AxisCurve {
            gain_deg: 10.0,
            scale_deg_s: 20.0,
            linear_deg: 0.0,
            ..curve
        };
        Self {
            name: "search".to_owned(),
            spread_deg: 11.0,
            yaw: wide(free.yaw),
            pitch: wide(free.pitch),
        }
    }

    /// The preset of a name: `free-viewing` or `search`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::free_viewing(), Self::search()]
            .into_iter()
            .find(|preset| preset.name == name)
    }

    /// Where the eyes look for a head that moves so, within what eyes can reach. Costs two
    /// hyperbolic tangents; finite for every finite motion.
    ///
    /// ```
    /// use foveal_core::gaze::head_prediction::HeadMotion;
    /// use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
    ///
    /// let turning_right = HeadMotion { velocity_deg_s: [20.0, 0.0], ..Default::default() };
    /// let gaze = HeadGazePreset::free_viewing().predict(&turning_right);
    /// assert!(gaze.yaw_deg > 5.0);
    /// ```
    #[must_use]
    pub fn predict(&self, motion: &HeadMotion) -> GazeInHead {
        let gaze = |curve: &AxisCurve, axis| curve.gaze_deg(curve.drive(motion, axis));
        GazeInHead::within_reach([gaze(&self.yaw, 0), gaze(&self.pitch, 1)])
    }

    /// One standard deviation of the eyes round a prediction for now.
    #[must_use]
    pub fn spread(&self) -> Radians {
        Radians::from_degrees(self.spread_deg)
    }

    /// Refuses numbers that are not finite or outside of [`AxisCurve::RANGES`], and a spread
    /// outside of 0.1 to 60 degrees.
    pub fn checked(self) -> Result<Self, PresetError> {
        within("spread_deg", self.spread_deg, [0.1, 60.0])?;
        for (axis, curve) in [("yaw", &self.yaw), ("pitch", &self.pitch)] {
            for ((name, range), value) in AxisCurve::RANGES.iter().zip(curve.parameters()) {
                within(&format!("{axis}.{name}"), value, *range)?;
            }
        }
        Ok(self)
    }
}

fn within(field: &str, found: f64, [least, most]: [f64; 2]) -> Result<(), PresetError> {
    if (least..=most).contains(&found) {
        return Ok(());
    }
    Err(PresetError {
        field: field.to_owned(),
        found,
        expected: format!("{least} to {most}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn motion(velocity: [f64; 2], acceleration: [f64; 2]) -> HeadMotion {
        HeadMotion {
            velocity_deg_s: velocity,
            mean_acceleration_deg_s2: acceleration,
            ..HeadMotion::default()
        }
    }

    proptest! {
        #[test]
        fn a_mirrored_head_gives_the_mirrored_gaze(
            v in -300.0..300.0f64, w in -300.0..300.0f64,
            a in -900.0..900.0f64, b in -900.0..900.0f64,
        ) {
            for preset in [HeadGazePreset::free_viewing(), HeadGazePreset::search()] {
                let offset = preset.yaw.offset_deg;
                let gaze = preset.predict(&motion([v, w], [a, b]));
                let mirrored = preset.predict(&motion([-v, w], [-a, b]));
                prop_assert!((gaze.yaw_deg - offset + mirrored.yaw_deg - offset).abs() < 1e-9);
                prop_assert_eq!(gaze.pitch_deg, mirrored.pitch_deg);
            }
        }

        #[test]
        fn gaze_never_falls_back_as_the_head_turns_faster(
            v in -300.0..300.0f64, more in 0.0..50.0f64,
        ) {
            for preset in [HeadGazePreset::free_viewing(), HeadGazePreset::search()] {
                for curve in [&preset.yaw, &preset.pitch] {
                    prop_assert!(curve.gaze_deg(v + more) >= curve.gaze_deg(v));
                }
            }
        }
    }

    #[test]
    fn the_side_that_presets_lean_to_is_small() {
        for preset in [HeadGazePreset::free_viewing(), HeadGazePreset::search()] {
            assert!(preset.yaw.offset_deg.abs() < 0.6);
        }
    }

    #[test]
    fn three_quarters_of_the_gain_are_reached_at_the_scale() {
        let curve = AxisCurve {
            linear_deg: 0.0,
            offset_deg: 0.0,
            ..HeadGazePreset::free_viewing().yaw
        };
        let share = curve.gaze_deg(curve.scale_deg_s) / curve.gain_deg;
        assert!((share - 0.76).abs() < 0.01, "{share}");
    }

    #[test]
    fn presets_have_names_and_wrong_numbers_are_named() {
        for name in ["free-viewing", "search"] {
            assert!(HeadGazePreset::named(name).unwrap().checked().is_ok());
        }
        assert_eq!(HeadGazePreset::named("reading"), None);
        let mut bad = HeadGazePreset::search();
        bad.pitch.scale_deg_s = f64::NAN;
        let error = bad.checked().unwrap_err().to_string();
        assert_eq!(error, "pitch.scale_deg_s is NaN; give 0.3 to 100");
    }
}
