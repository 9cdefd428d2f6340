//! Which unit does a number carry?
//!
//! Newtypes for the quantities that are easy to mix up. Angles are radians inside; degrees only
//! where a name says so.

use serde::{Deserialize, Serialize};

/// An angle in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Radians(pub f64);

impl Radians {
    /// The angle of `degrees` degrees.
    #[must_use]
    pub fn from_degrees(degrees: f64) -> Self {
        Self(degrees * (core::f64::consts::PI / 180.0))
    }

    /// This angle in degrees.
    #[must_use]
    pub fn to_degrees(self) -> f64 {
        self.0 * (180.0 / core::f64::consts::PI)
    }
}

/// Spatial frequency in cycles per degree of visual angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Cpd(pub f64);

/// Pixels per degree of visual angle, at one place of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Ppd(pub f64);

/// Media or session time in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Seconds(pub f64);
