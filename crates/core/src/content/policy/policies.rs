//! Which policies are there, and what is known of each?
//!
//! Command line, window and page follow from this table: names, help, which options a policy goes
//! by, and which tables of a pack it needs.

use crate::content::policy::Policy;

/// What is known of a policy.
#[derive(Clone, Copy, Debug)]
pub struct PolicyFacts {
    /// As users write it.
    pub name: &'static str,
    /// What it chooses.
    pub help: &'static str,
    /// Whether it spends a budget on units of known size, step by step; else it is a rule, or
    /// keeps a score.
    pub spends_a_budget: bool,
    /// Whether it can be given a score to choose for.
    pub has_target: bool,
    /// Whether it keeps a score unless something else is asked for.
    pub keeps_a_score: bool,
    /// The options that it alone, or with few others, goes by.
    pub options: &'static [&'static str],
    /// Whether a page can choose by it.
    pub on_page: bool,
}

/// A policy without options of its own.
const PLAIN: PolicyFacts = PolicyFacts {
    name: "",
    help: "",
    spends_a_budget: false,
    has_target: false,
    keeps_a_score: false,
    options: &[],
    on_page: true,
};

/// A policy that spends a budget.
const SPENDING: PolicyFacts = PolicyFacts {
    spends_a_budget: true,
    has_target: true,
    options: &["target"],
    ..PLAIN
};

impl Policy {
    /// All policies, in the order of their explanation.
    pub const ALL: [Self; 10] = [
        Self::Full,
        Self::Coarsest,
        Self::Viewport,
        Self::Grid,
        Self::Distance,
        Self::Sampled,
        Self::Acuity,
        Self::Uniform,
        Self::Eccentricity,
        Self::Perceptual,
    ];

    /// All policies, in the order in which a viewer goes through them.
    pub const IN_TURN: [Self; 10] = [
        Self::Viewport,
        Self::Acuity,
        Self::Perceptual,
        Self::Eccentricity,
        Self::Uniform,
        Self::Grid,
        Self::Distance,
        Self::Sampled,
        Self::Full,
        Self::Coarsest,
    ];

    /// What is known of it.
    #[must_use]
    pub const fn facts(self) -> PolicyFacts {
        match self {
            Self::Full => PolicyFacts {
                name: "full",
                help: "Everything at the finest level, in view or not",
                ..PLAIN
            },
            Self::Coarsest => PolicyFacts {
                name: "coarsest",
                help: "The coarsest level alone",
                ..PLAIN
            },
            Self::Viewport => PolicyFacts {
                name: "viewport",
                help: "What is in view, as fine as the display shows it",
                options: &["margin"],
                ..PLAIN
            },
            Self::Grid => PolicyFacts {
                name: "grid",
                help: "The cell of the gaze finest, its neighbours middle, the rest coarsest",
                options: &["edge_rule", "edge_margin", "noisy_cells", "noise_threshold"],
                ..PLAIN
            },
            Self::Distance => PolicyFacts {
                name: "distance",
                help: "A level by the angle between tile and gaze",
                options: &["slope", "thresholds"],
                ..PLAIN
            },
            Self::Sampled => PolicyFacts {
                name: "sampled",
                help: "Tiles by distance, of which only samples are shown",
                options: &[
                    "slope",
                    "thresholds",
                    "samples",
                    "mask_size",
                    "interpolation",
                ],
                on_page: false,
                ..PLAIN
            },
            Self::Acuity => PolicyFacts {
                name: "acuity",
                help: "Levels as fine as the eye resolves at their eccentricity",
                has_target: true,
                keeps_a_score: true,
                options: &["target", "slope", "safety_disc"],
                ..PLAIN
            },
            Self::Uniform => PolicyFacts {
                name: "uniform",
                help: "Units in view, raised evenly within --link",
                ..SPENDING
            },
            Self::Eccentricity => PolicyFacts {
                name: "eccentricity",
                help: "Units by acuity per byte within --link",
                ..SPENDING
            },
            Self::Perceptual => PolicyFacts {
                name: "perceptual",
                help: "Units by what they are worth to the eye per byte within --link",
                keeps_a_score: true,
                options: &["target", "saliency", "importance"],
                ..SPENDING
            },
        }
    }

    /// As users write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// The policy that users write so.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|policy| policy.name() == name)
    }

    /// Whether this policy spends a budget on units of known size, step by step; else it is a rule,
    /// or keeps a score.
    #[must_use]
    pub const fn spends_a_budget(self) -> bool {
        self.facts().spends_a_budget
    }

    /// Whether this policy can be given a score to choose for.
    #[must_use]
    pub const fn has_target(self) -> bool {
        self.facts().has_target
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_policy_stands_once_in_both_orders_under_the_name_that_logs_have() {
        for policy in Policy::ALL {
            let in_turn = Policy::IN_TURN.iter().filter(|other| **other == policy);
            assert_eq!(in_turn.count(), 1, "{policy:?}");
            let logged = serde_json::to_string(&policy).unwrap();
            assert_eq!(logged, format!("\"{}\"", policy.name()));
            assert_eq!(Policy::named(policy.name()), Some(policy));
        }
        assert_eq!(Policy::named("best"), None);
    }

    #[test]
    fn who_has_a_target_is_told_it_by_an_option() {
        for facts in Policy::ALL.map(Policy::facts) {
            assert_eq!(
                facts.has_target,
                facts.options.contains(&"target"),
                "{}",
                facts.name
            );
            assert!(facts.has_target || !facts.keeps_a_score, "{}", facts.name);
        }
    }
}
