//! Which of the choices that the published program and a right one make differently is made?

use serde::Serialize;

/// A set of rules by name; a result always carries it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// As the published package pyfvvdp 1.2.2 computes: comparable with published scores.
    #[default]
    Compat,
    /// Right where that one slips: see [`ScoreRules::STRICT`].
    Strict,
}

impl Mode {
    /// What it stands for.
    #[must_use]
    pub fn rules(self) -> ScoreRules {
        match self {
            Self::Compat => ScoreRules::COMPAT,
            Self::Strict => ScoreRules::STRICT,
        }
    }
}

/// The four choices, each of which can be made alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScoreRules {
    /// At the right border of a level.
    pub border: Border,
    /// Where sensitivity comes from.
    pub sensitivity: SensitivityRule,
    /// Where a pixel lies before the eye.
    pub geometry: GeometryRule,
    /// When the temporal filters are sampled.
    pub sampling: SamplingRule,
}

/// Which samples the last column of a halved level takes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// Those that the parity of the number of *rows* asks for, as published: wrong where rows and
    /// columns differ in parity.
    ByRows,
    /// Those that the parity of the number of columns asks for.
    ByColumns,
}

/// Where the sensitivity of the eye is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensitivityRule {
    /// In a table of 32 x 32 x 32 entries, as published.
    Coarse,
    /// In one so fine that it is the formula.
    Fine,
}

/// Which angles a pixel has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryRule {
    /// The frame is stretched over the whole panel, and eccentricity is the Euclidean distance of
    /// two pairs of angles, as published.
    Stretched,
    /// The frame lies in the middle of the panel at its own size, and eccentricity is the angle
    /// between two rays.
    TrueRays,
}

/// When the temporal filters are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplingRule {
    /// At n times evenly from 0 to n frames, both included, as published: wider apart than frames.
    Widened,
    /// At the times of the frames.
    Frames,
}

impl ScoreRules {
    /// All as published.
    pub const COMPAT: Self = Self {
        border: Border::ByRows,
        sensitivity: SensitivityRule::Coarse,
        geometry: GeometryRule::Stretched,
        sampling: SamplingRule::Widened,
    };
    /// All right.
    pub const STRICT: Self = Self {
        border: Border::ByColumns,
        sensitivity: SensitivityRule::Fine,
        geometry: GeometryRule::TrueRays,
        sampling: SamplingRule::Frames,
    };
}
