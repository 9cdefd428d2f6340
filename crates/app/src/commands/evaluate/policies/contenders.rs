//! Which policies are compared, and what makes each of them cheaper?

use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::perception::acuity::AcuityModel;
use foveal_core::view::surface::Projection;

/// A policy as it is played: a point of a curve.
#[derive(Clone, Debug)]
pub(super) struct Contender {
    /// What it shares with those that differ from it by slope, rate or target alone.
    pub(super) curve: String,
    pub(super) config: PolicyConfig,
    /// Of the eye of `acuity`, degrees of a pixel a degree.
    pub(super) slope: Option<f64>,
    /// Of the link, Mbit/s; none for content at hand.
    pub(super) rate_mbit: Option<f64>,
    /// The score that levels are chosen for, JOD.
    pub(super) target: Option<f64>,
}

/// What the curves run over.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ladders<'a> {
    pub(super) slopes: &'a [f64],
    pub(super) rates: &'a [f64],
    pub(super) targets: &'a [f64],
}

/// Curve of `acuity` by slope, which others are compared with.
pub(super) const ACUITY: &str = "acuity by slope";
/// Curve of `viewport`, which others are compared with.
pub(super) const VIEWPORT: &str = "viewport";

impl Contender {
    fn new(config: PolicyConfig) -> Self {
        Self {
            curve: config.policy.name().to_owned(),
            config,
            slope: None,
            rate_mbit: None,
            target: None,
        }
    }

    /// The policy as users write it.
    pub(super) fn policy(&self) -> &'static str {
        self.config.policy.name()
    }

    /// Bytes a second of its link.
    pub(super) fn bytes_per_s(&self) -> f64 {
        self.rate_mbit
            .map_or(f64::INFINITY, |rate| rate * 1e6 / 8.0)
    }

    /// What it differs by from others of its curve.
    pub(super) fn step(&self) -> String {
        let slope = self.slope.map(|slope| slope.to_string());
        let rate = self.rate_mbit.map(|rate| format!("{rate} Mbit/s"));
        let target = self.target.map(|target| format!("{target} JOD"));
        slope.or(rate).or(target).unwrap_or_default()
    }
}

/// All that are compared on content of a projection, baselines first.
pub(super) fn contenders(ladders: Ladders<'_>, projection: Projection) -> Vec<Contender> {
    let plain = |policy| Contender::new(PolicyConfig::new(policy));
    let mut all = vec![plain(Policy::Full), plain(Policy::Viewport)];
    // On a flat picture the thesis samples by distance; its grid is for panoramas.
    all.extend(projection.surrounds().then(|| plain(Policy::Grid)));
    all.push(Contender {
        curve: "acuity watson".to_owned(),
        ..Contender::new(PolicyConfig {
            acuity: AcuityModel::Watson,
            ..PolicyConfig::new(Policy::Acuity)
        })
    });
    all.extend(ladders.slopes.iter().map(|slope| Contender {
        curve: ACUITY.to_owned(),
        slope: Some(*slope),
        ..Contender::new(PolicyConfig {
            acuity: AcuityModel::linear(*slope),
            ..PolicyConfig::new(Policy::Acuity)
        })
    }));
    let of_units = [Policy::Uniform, Policy::Eccentricity, Policy::Perceptual];
    for policy in of_units {
        all.extend(ladders.rates.iter().map(|rate| Contender {
            curve: format!("{} by rate", policy.name()),
            rate_mbit: Some(*rate),
            ..plain(policy)
        }));
    }
    for policy in [Policy::Acuity].into_iter().chain(of_units) {
        all.extend(ladders.targets.iter().map(|target| Contender {
            curve: format!("{} by target", policy.name()),
            target: Some(*target),
            ..Contender::new(PolicyConfig {
                target: Some(*target),
                ..PolicyConfig::new(policy)
            })
        }));
    }
    all
}
