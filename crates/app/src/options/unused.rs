//! Which options that were given change nothing?

use crate::options::policy::PolicyName;
use clap::ArgMatches;
use clap::parser::ValueSource;

/// Options, and the policies that go by them.
const POLICIES_OF: [(&str, &[PolicyName]); 13] = [
    (
        "target",
        &[
            PolicyName::Acuity,
            PolicyName::Uniform,
            PolicyName::Eccentricity,
            PolicyName::Perceptual,
        ],
    ),
    (
        "slope",
        &[
            PolicyName::Acuity,
            PolicyName::Distance,
            PolicyName::Sampled,
        ],
    ),
    ("safety_disc", &[PolicyName::Acuity]),
    ("margin", &[PolicyName::Viewport]),
    ("edge_rule", &[PolicyName::Grid]),
    ("edge_margin", &[PolicyName::Grid]),
    ("noisy_cells", &[PolicyName::Grid]),
    ("noise_threshold", &[PolicyName::Grid]),
    ("thresholds", &[PolicyName::Distance, PolicyName::Sampled]),
    ("samples", &[PolicyName::Sampled]),
    ("mask_size", &[PolicyName::Sampled]),
    ("interpolation", &[PolicyName::Sampled]),
    ("saliency", &[PolicyName::Perceptual]),
];

/// A line for each option that was given to `simulate` or `select` for another policy.
pub(crate) fn unused_options(matches: &ArgMatches) -> Vec<String> {
    let Some((name @ ("simulate" | "select"), given)) = matches.subcommand() else {
        return Vec::new();
    };
    // A preset brings its own policy, which the content decides.
    if given.value_source("preset") == Some(ValueSource::CommandLine) {
        return Vec::new();
    }
    let policy = given.get_one::<PolicyName>("policy").copied();
    let is_given = |id| {
        let known = given.try_contains_id(id).is_ok();
        known && given.value_source(id) == Some(ValueSource::CommandLine)
    };
    let is_of_acuity = ["slope", "acuity", "safety_disc"].into_iter().any(is_given);
    let policy = policy.unwrap_or(match is_of_acuity || name == "select" {
        true => PolicyName::Acuity,
        false => PolicyName::Perceptual,
    });
    let unused = POLICIES_OF.iter().filter(|(_, of)| !of.contains(&policy));
    unused
        .filter(|(id, _)| is_given(id))
        .map(|(id, of)| {
            let names: Vec<String> = of.iter().map(|policy| policy.name()).collect();
            format!(
                "foveal: --{} changes nothing with --policy {}; it is for {}",
                id.replace('_', "-"),
                policy.name(),
                names.join(", "),
            )
        })
        .collect()
}
