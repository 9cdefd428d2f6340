//! Which target makes the foveated frames as good as those of a published rule?
//!
//! What a rule scores is measured, and so is what a target gives: what was predicted is off by some
//! tenths of a JOD.

use crate::commands::bench::video::arms::Published;
use crate::report::output;
use crate::run::timed::{Conditions, Way};
use foveal_core::content::policy::PolicyConfig;
use foveal_core::content::policy::asked::TARGETS;

/// Targets that are tried: each halves the range in which the right one lies.
const TRIALS: u32 = 7;

/// The lowest target at which the foveated frames score at least what the published rule does, as
/// near as a few trials come; as it was where nothing draws, or the policy has no target.
pub(super) fn as_good_as(
    published: &Published<'_>,
    conditions: &Conditions<'_>,
    config: PolicyConfig,
) -> anyhow::Result<PolicyConfig> {
    let Some(wanted) = published.score.filter(|_| config.policy.has_target()) else {
        return Ok(config);
    };
    output::say(&format!(
        "{} under {} scores {wanted:.2} JOD; looking for the target that does",
        published.system.name(),
        published.way.config.policy.name(),
    ));
    let at = |target| PolicyConfig {
        target: Some(target),
        ..config.clone()
    };
    let (mut low, mut high) = (*TARGETS.start(), *TARGETS.end());
    for _ in 0..TRIALS {
        let middle = low.midpoint(high);
        let score = conditions.score(&Way::of(at(middle)))?;
        if score.is_some_and(|score| score >= wanted) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(at(high))
}
