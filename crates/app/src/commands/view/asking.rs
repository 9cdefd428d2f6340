//! Which policy, and which score, does a key go to?

use crate::commands::view::viewer::Viewer;
use foveal_core::content::asked::next_target;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::units::Seconds;
use foveal_play::LivePlayer;

/// The policies that a key goes through.
const POLICIES: [Policy; 10] = [
    Policy::Viewport,
    Policy::Acuity,
    Policy::Perceptual,
    Policy::Eccentricity,
    Policy::Uniform,
    Policy::Grid,
    Policy::Distance,
    Policy::Sampled,
    Policy::Full,
    Policy::Coarsest,
];

impl Viewer {
    /// Whether the pack has what a policy chooses by.
    fn can(&self, stage: &LivePlayer, policy: Policy) -> bool {
        let config = PolicyConfig {
            policy,
            ..stage.session().policy_in_use().clone()
        };
        stage.session().can(&config)
    }

    /// Chooses by the next policy, or the one before, that the pack has the tables for.
    pub(super) fn next_policy(&mut self, by: i32, stage: &mut LivePlayer, now: Seconds) {
        let count = POLICIES.len();
        let at = POLICIES
            .iter()
            .position(|p| *p == stage.session().policy().policy);
        let step = if by > 0 { 1 } else { count - 1 };
        let following = (1..=count).map(|k| POLICIES[(at.unwrap_or(0) + k * step) % count]);
        let possible = following
            .into_iter()
            .find(|policy| self.can(stage, *policy));
        let Some(policy) = possible else {
            return;
        };
        match self.policy.config_of(policy) {
            Ok(config) => {
                stage.session_mut().change_policy(config);
                let mut style = stage.style();
                style.samples = policy == Policy::Sampled;
                style.has_textures &= !style.samples;
                let said = format!("policy {}", policy.name());
                self.take_style(style, stage, said, now);
            }
            Err(error) => self.say(error.to_string(), now),
        }
    }

    /// Chooses for a higher score, or a lower one; policies that are gone to later do, too.
    pub(super) fn next_target(&mut self, by: i32, stage: &mut LivePlayer, now: Seconds) {
        let policy = stage.session().policy().policy;
        if !policy.has_target() {
            return self.say(
                format!("policy {} chooses for no score", policy.name()),
                now,
            );
        }
        let target = next_target(stage.session().policy().target, by);
        let options = self.policy.for_score(target);
        match options.config_of(policy) {
            Ok(config) => {
                self.policy = options;
                stage.session_mut().change_policy(config);
                let said = target.map_or("no target score".to_owned(), |jod| {
                    format!("target score {jod}")
                });
                self.say(said, now);
            }
            Err(error) => self.say(error.to_string(), now),
        }
    }
}
