//! Which policy, and which score, does a key go to?

use crate::commands::view::window_player::WindowPlayer;
use foveal_core::content::policy::asked::next_target;
use foveal_core::content::policy::{Policy, PolicyConfig};
use foveal_core::session::actions::SessionEvent;
use foveal_core::units::Seconds;

impl WindowPlayer {
    /// Whether the pack has what a policy chooses by.
    fn can(&self, policy: Policy) -> bool {
        let config = PolicyConfig {
            policy,
            ..self.live.session().policy_in_use().clone()
        };
        let is_of_kind = self.live.opened().why_not(policy).is_none();
        let has_place = policy != Policy::Sampled || !self.has_panels();
        is_of_kind && has_place && self.live.session().can(&config)
    }

    fn choose_by(&mut self, config: PolicyConfig) {
        let chosen = SessionEvent::PolicyChosen(Box::new(config));
        self.live.session_mut().take(chosen);
    }

    /// Chooses by the next policy, or the one before, that the pack has the tables for.
    pub(super) fn next_policy(&mut self, by: i32, now: Seconds) {
        let policies = Policy::IN_TURN;
        let count = policies.len();
        let at = policies
            .iter()
            .position(|p| *p == self.live.session().policy().policy);
        let step = if by > 0 { 1 } else { count - 1 };
        let following = (1..=count).map(|k| policies[(at.unwrap_or(0) + k * step) % count]);
        let possible = following.into_iter().find(|policy| self.can(*policy));
        let Some(policy) = possible else {
            return;
        };
        match self.policy.config_of(policy) {
            Ok(config) => {
                self.choose_by(config);
                let mut style = self.live.style();
                style.samples = policy == Policy::Sampled;
                style.has_textures &= !style.samples;
                let said = format!("policy {}", policy.name());
                self.take_style(style, said, now);
            }
            Err(error) => self.say(error.to_string(), now),
        }
    }

    /// Chooses for a higher score, or a lower one; policies that are gone to later do, too.
    pub(super) fn next_target(&mut self, by: i32, now: Seconds) {
        let policy = self.live.session().policy().policy;
        if !(self.facts().scored)(policy) {
            return self.say(
                format!("policy {} chooses for no score", policy.name()),
                now,
            );
        }
        let target = next_target(self.live.session().policy().target, by);
        let options = self.policy.for_score(target);
        match options.config_of(policy) {
            Ok(config) => {
                self.policy = options;
                self.choose_by(config);
                let said = target.map_or("no target score".to_owned(), |jod| {
                    format!("target score {jod}")
                });
                self.say(said, now);
            }
            Err(error) => self.say(error.to_string(), now),
        }
    }
}
