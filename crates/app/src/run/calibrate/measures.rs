//! How much of a content is judged, and what is found at one bound?

use foveal_core::content::video::calibration::{ZONES, ZoneLosses};

/// How much of a content is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CalibrationExtent {
    /// As much as about a minute of CPU time allows.
    Usual,
    /// Five gazes, all densities and bounds.
    Thorough,
}

/// What the judge found at one bound of one density.
#[derive(Clone, Debug, Default)]
pub(super) struct FoundAtBound {
    /// Of each glimpse.
    pub(super) jods: Vec<f64>,
    /// By zone, of each glimpse in which it is seen.
    pub(super) zones: [Vec<f64>; ZONES],
    pub(super) losses: ZoneLosses,
    pub(super) shares: Vec<f64>,
    pub(super) bytes: Vec<f64>,
}
