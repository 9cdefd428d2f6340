//! What may be asked of selection: which policy, with which parameters?

pub mod asked;
pub mod calibration;
pub mod policies;

use crate::content::policy::calibration::{Expectation, slope_for};
use crate::perception::acuity::AcuityModel;
use crate::perception::parameters::Parameters;
use crate::units::Radians;
use serde::{Deserialize, Serialize};

/// How levels are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Policy {
    /// Every finest tile: the baseline of all ratios.
    Full,
    /// Only the coarsest level: the other end.
    Coarsest,
    /// What is in view plus a margin at display density, the rest coarsest: what the industry
    /// ships.
    Viewport,
    /// Kastner 2016 on panoramas: the gaze's cell finest, its neighbours middle, the rest coarsest.
    Grid,
    /// Kastner 2016 on wide screens: a level by the distance to the gaze, nothing finer than the
    /// coarsest out of view.
    Distance,
    /// Kastner 2016 on wide screens: tiles as under `distance`, of which only samples are shown,
    /// as dense round the gaze as the eye's acuity.
    Sampled,
    /// The coarsest level that still meets the eye's limit everywhere in a cell.
    Acuity,
    /// UNI: everything in view is raised evenly, one level at a time.
    Uniform,
    /// ECC: acuity plus a pedestal, per byte: no content, no popping.
    Eccentricity,
    /// OURS: what a step is worth to the eye, per byte (Chen et al. 2022, corrected).
    Perceptual,
}

impl Policy {
    /// How signatures predict the score of what this policy chooses.
    #[must_use]
    pub fn expectation(self) -> Expectation {
        match self {
            Self::Perceptual => Expectation::ByLoss,
            _ => Expectation::Elsewise,
        }
    }

    /// The policy under which a judge sees content for an expectation.
    #[must_use]
    pub fn judged_for(expectation: Expectation) -> Self {
        match expectation {
            Expectation::ByLoss => Self::Perceptual,
            Expectation::Elsewise => Self::Acuity,
        }
    }
}

/// How far a gaze strays that means to stay: fixational eye movements and a tracker's noise.
pub const STEADINESS: Radians = Radians(core::f64::consts::PI / 180.0);

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde calls it with a reference"
)]
fn is_none(angle: &Radians) -> bool {
    angle.0 == 0.0
}

/// Pixels on a side of a sample mask unless another size is asked for (Kastner 2016).
pub const MASK_SIDE: u32 = 1920;

/// Which pixels round the gaze `sampled` shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MaskConfig {
    /// Pixels of the view on a side of the square that samples lie in.
    pub side: u32,
    /// How many samples; `None` for as many as the eye's acuity asks for.
    pub samples: Option<u32>,
}

impl Default for MaskConfig {
    fn default() -> Self {
        Self {
            side: MASK_SIDE,
            samples: None,
        }
    }
}

impl MaskConfig {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Which cells the `grid` policy shows at the finest level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EdgeRule {
    /// Every cell within the margin of the gaze, borders included.
    #[default]
    Conservative,
    /// Only the cell that the gaze is in.
    Single,
}

/// How much an eye gets from the units of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ImportanceSource {
    /// Signatures, which were measured while preparing, and footprints in what is drawn.
    #[default]
    Signatures,
    /// Pictures of all levels, drawn for each choice: slow, the reference for signatures.
    Rendered,
}

impl ImportanceSource {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A policy with its parameters; written into session logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyConfig {
    /// The rule.
    pub policy: Policy,
    /// The eye of `acuity`.
    pub acuity: AcuityModel,
    /// `acuity`: radius round the gaze within which everything is finest and beyond which
    /// eccentricity counts.
    pub safety_disc: Radians,
    /// `viewport`: what is kept fine around the view.
    pub margin: Radians,
    /// `grid`: which cells are finest.
    pub edge_rule: EdgeRule,
    /// `grid`: how near a cell must be to the gaze to be finest.
    pub edge_margin: Radians,
    /// `grid`: how many cells of the lowest level, in index order, count as noisy and are promoted
    /// to the middle level.
    pub noisy_cells: u32,
    /// `grid`: mean variance of red, green and blue, in squared 8-bit code values, above which a
    /// cell of the lowest level is promoted to the middle level; `None` looks at no content.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_threshold: Option<f64>,
    /// `distance`, `sampled`: angle from the gaze up to which each level is shown, finest first,
    /// rising; beyond the last all is coarsest. Empty: where acuity allows the next level.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub thresholds: Vec<Radians>,
    /// `sampled`: which samples are shown.
    #[serde(default, skip_serializing_if = "MaskConfig::is_default")]
    pub mask: MaskConfig,
    /// How far the gaze may go before what it leaves becomes coarser, for policies that spend no
    /// budget; see [`steady`](super::steady).
    #[serde(default, skip_serializing_if = "is_none")]
    pub steadiness: Radians,
    /// `perceptual`, `eccentricity`: what a step is worth.
    #[serde(default)]
    pub perception: Parameters,
    /// `perceptual`: whether saliency says what to fetch outside the region that gaze predicts.
    #[serde(default)]
    pub saliency: bool,
    /// `perceptual` on scenes: how the worth of units is found.
    #[serde(default, skip_serializing_if = "ImportanceSource::is_default")]
    pub importance: ImportanceSource,
    /// `acuity`, `perceptual`: the score that levels are chosen for, in JOD. Where bytes are
    /// limited, and under `uniform` and `eccentricity`: the score at which buying stops. `None`:
    /// `acuity` as above, and what is worth anything is bought.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<f64>,
    /// `perceptual`: the visible loss that no cell may pass, in the place of what keeps the target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
    /// Through several views: whether tiles cover the finest level of every cell at once. Else
    /// those of each view cover what it asks for, and a cell becomes as fine as any of them makes
    /// it: as sessions without panels do.
    #[serde(default, skip_serializing_if = "is_false")]
    pub together: bool,
}

fn is_false(value: &bool) -> bool {
    !value
}

/// The score that levels are chosen for unless another is asked for: what about 63 of 100 people
/// could distinguish from the finest when asked to guess.
pub const DEFAULT_TARGET: f64 = 9.5;

/// The side tables that a pack has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HasTables {
    /// What each unit adds.
    pub signatures: bool,
    /// What might draw the eye.
    pub cues: bool,
}

impl HasTables {
    /// All of them.
    pub const ALL: Self = Self {
        signatures: true,
        cues: true,
    };
}

impl PolicyConfig {
    /// A policy with its default parameters.
    #[must_use]
    pub fn new(policy: Policy) -> Self {
        Self {
            policy,
            acuity: AcuityModel::LINEAR,
            safety_disc: Radians(0.0),
            margin: Radians::from_degrees(10.0),
            edge_rule: EdgeRule::Conservative,
            edge_margin: Radians(0.0),
            noisy_cells: 0,
            noise_threshold: None,
            thresholds: Vec::new(),
            mask: MaskConfig::default(),
            steadiness: STEADINESS,
            perception: Parameters::default(),
            saliency: false,
            importance: ImportanceSource::default(),
            target: None,
            bound: None,
            together: false,
        }
    }

    /// The same for content without signatures: `acuity`, at the slope by which
    /// content of unknown texture keeps the target, in the place of what weighs units.
    #[must_use]
    pub fn without_signatures(&self) -> Self {
        let policy = match self.policy {
            Policy::Perceptual => Policy::Acuity,
            other => other,
        };
        let acuity = match self.target {
            Some(target) if policy == Policy::Acuity => AcuityModel::linear(slope_for(target)),
            _ => self.acuity.clone(),
        };
        Self {
            policy,
            acuity,
            target: None,
            ..self.clone()
        }
    }

    /// Whether choosing takes what units add: without signatures
    /// [`Self::without_signatures`] stands in, or nothing can.
    #[must_use]
    pub fn needs_signatures(&self) -> bool {
        self.policy.spends_a_budget() || self.target.is_some()
    }

    /// Whether content with these tables has what this policy chooses by.
    #[must_use]
    pub fn is_met_by(&self, has: HasTables) -> bool {
        (!self.policy.spends_a_budget() || has.signatures)
            && (!self.needs_cues() || has.signatures && has.cues)
    }

    /// Whether this policy looks at cues of the content.
    #[must_use]
    pub fn needs_cues(&self) -> bool {
        self.policy == Policy::Grid && self.noise_threshold.is_some()
    }
}
