//! Which policies can be named, and who chooses where none is?

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use foveal_core::content::policy::Policy;

/// Reads a policy by its name.
pub(crate) fn policy_parser() -> impl TypedValueParser<Value = Policy> {
    named_or(Vec::new()).try_map(|name| Policy::named(&name).ok_or("no policy"))
}

/// The value of `--policy`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PolicyChoice {
    /// The rule that shows fewer pixels at the target, as far as a pack knows.
    Auto,
    Is(Policy),
}

/// The value of `--policy` where several can be played.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PoliciesChoice {
    One(PolicyChoice),
    /// Both rules that keep a target.
    All,
}

impl PolicyChoice {
    /// The policy that was named.
    pub(crate) fn named(self) -> Option<Policy> {
        match self {
            Self::Is(policy) => Some(policy),
            Self::Auto => None,
        }
    }
}

const AUTO: &str = "auto";
const ALL: &str = "all";

/// Reads a policy by its name, or auto.
pub(crate) fn policy_choice_parser() -> impl TypedValueParser<Value = PolicyChoice> {
    named_or(vec![auto()]).try_map(|name| choice(&name))
}

/// Reads a policy by its name, auto, or all.
pub(crate) fn policies_choice_parser() -> impl TypedValueParser<Value = PoliciesChoice> {
    let all = PossibleValue::new(ALL).help("perceptual and acuity, in turns");
    named_or(vec![auto(), all]).try_map(|name| match name == ALL {
        true => Ok(PoliciesChoice::All),
        false => choice(&name).map(PoliciesChoice::One),
    })
}

fn auto() -> PossibleValue {
    PossibleValue::new(AUTO).help(
        "whichever of perceptual and acuity shows fewer pixels of this content at the target, by \
         its calibration",
    )
}

fn named_or(others: Vec<PossibleValue>) -> PossibleValuesParser {
    let value = |policy: Policy| PossibleValue::new(policy.name()).help(policy.facts().help);
    PossibleValuesParser::new(others.into_iter().chain(Policy::ALL.map(value)))
}

fn choice(name: &str) -> Result<PolicyChoice, &'static str> {
    match name == AUTO {
        true => Ok(PolicyChoice::Auto),
        false => Policy::named(name).map(PolicyChoice::Is).ok_or("no policy"),
    }
}
