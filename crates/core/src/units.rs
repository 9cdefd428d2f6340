//! Which unit does a number carry?
//!
//! Newtypes for the quantities that are easy to mix up. Angles are radians inside; degrees only
//! where a name says so.

use core::fmt::Display;
use serde::{Deserialize, Serialize};

/// Text that a file or a sender gave, as a part of a line: control characters, line ends among
/// them, as `\u{a}`.
///
/// ```
/// use foveal_core::units::one_line;
/// assert_eq!(one_line("a\nb"), "a\\u{a}b");
/// ```
#[must_use]
pub fn one_line(text: &str) -> String {
    let shown = |letter: char| match letter.is_control() {
        true => letter.escape_unicode().to_string(),
        false => letter.to_string(),
    };
    text.chars().map(shown).collect()
}

/// A whole number and what it counts, in the plural but for one.
///
/// ```
/// use foveal_core::units::counted;
/// assert_eq!(counted(1, "frame"), "1 frame");
/// assert_eq!(counted(0, "late frame"), "0 late frames");
/// ```
#[must_use]
pub fn counted(number: impl Display, what: &str) -> String {
    let number = number.to_string();
    let ending = if number == "1" { "" } else { "s" };
    format!("{number} {what}{ending}")
}

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
