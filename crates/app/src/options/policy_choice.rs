//! Which policies can be named, and who chooses where none is?

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use foveal_core::content::policy::Policy;

/// Reads a policy by its name.
pub(crate) fn policy_parser() -> impl TypedValueParser<Value = Policy> {
    let value = |policy: Policy| PossibleValue::new(policy.name()).help(policy.facts().help);
    let names = Policy::ALL.map(value);
    PossibleValuesParser::new(names).try_map(|name| Policy::named(&name).ok_or("no policy"))
}

/// The value of `--policy`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PolicyChoice {
    /// The rule that shows fewer pixels at the target, as far as a pack knows.
    Auto,
    Is(Policy),
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

/// Reads a policy by its name, or auto.
pub(crate) fn policy_choice_parser() -> impl TypedValueParser<Value = PolicyChoice> {
    const AUTO: &str = "auto";
    let value = |policy: Policy| PossibleValue::new(policy.name()).help(policy.facts().help);
    let auto = PossibleValue::new(AUTO).help(
        "whichever of perceptual and acuity shows fewer pixels of this content at the target, by \
         its calibration",
    );
    let names = [auto].into_iter().chain(Policy::ALL.map(value));
    PossibleValuesParser::new(names).try_map(|name| match name == AUTO {
        true => Ok(PolicyChoice::Auto),
        false => Policy::named(&name)
            .map(PolicyChoice::Is)
            .ok_or("no policy"),
    })
}
