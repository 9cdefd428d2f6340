//! How does a head turn at one moment?

use crate::units::Seconds;

/// How fast a head turns, yaw to the right first, pitch up second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeadMotion {
    /// When, by the clock of the source.
    pub time: Seconds,
    /// Angular velocity in degrees per second.
    pub velocity_deg_s: [f64; 2],
    /// Mean angular acceleration of the last 20 ms in degrees per second squared.
    pub mean_acceleration_deg_s2: [f64; 2],
}

/// What the model of Hu et al. 2019 reads of a head, beyond its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SgazeMotion {
    /// Velocity and mean acceleration.
    pub motion: HeadMotion,
    /// Acceleration of the yaw now, in degrees per second squared.
    pub yaw_acceleration_deg_s2: f64,
    /// Standard deviation of the velocity over the last 10 s, in degrees per second.
    pub velocity_deviation_deg_s: [f64; 2],
    /// The most salient place of the view in degrees; `None` where it was not searched for.
    pub salient_deg: Option<[f64; 2]>,
}
