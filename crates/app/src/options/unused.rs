//! Which options that were given change nothing?

use crate::report::output;
use clap::ArgMatches;
use clap::parser::ValueSource;
use foveal_core::content::opened::ContentFacts;
use foveal_core::content::policy::Policy;
use std::collections::BTreeSet;

/// Options of `simulate` that say how tiles are decoded and shown.
const OF_TILES: [&str; 7] = [
    "blur",
    "reconstruction",
    "screen",
    "eye",
    "decoder",
    "jobs",
    "preset",
];

/// The options of a command that its caller gave.
pub(crate) struct Given(BTreeSet<String>);

impl Given {
    /// Those of the command that was called.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let Some((_, given)) = matches.subcommand() else {
            return Self(BTreeSet::new());
        };
        let ids = given.ids().map(|id| id.as_str());
        let is_given = |id: &&str| given.value_source(id) == Some(ValueSource::CommandLine);
        Self(ids.filter(is_given).map(str::to_owned).collect())
    }

    fn has(&self, id: &str) -> bool {
        self.0.contains(id)
    }

    /// Says which options are for another content, or for another policy than the named one; where
    /// none is named and no option is of `acuity`, `usual` chooses.
    pub(crate) fn say_unused(
        &self,
        (about, is_flat): (&ContentFacts, bool),
        (named, usual): (Option<Policy>, Policy),
    ) {
        if is_flat && self.has("fov") {
            output::say(
                "warning: --fov changes nothing for flat content, whose screen sets how wide it \
                 is; give --screen INCHES,METRES",
            );
        }
        // A preset brings its own policy, which the content decides.
        if self.has("preset") {
            return;
        }
        let is_of_acuity = ["slope", "acuity", "safety_disc"]
            .iter()
            .any(|id| self.has(id));
        let usual = if is_of_acuity { Policy::Acuity } else { usual };
        self.say_of_policy(named.unwrap_or(usual));
        let of_tiles = OF_TILES.iter().filter(|id| self.has(id));
        for id in of_tiles.filter(|id| **id != "eye" || !self.has("panels")) {
            if !about.has_tiles {
                output::say(&format!(
                    "warning: --{} changes nothing for a {}; it is for video",
                    id.replace('_', "-"),
                    about.noun
                ));
            }
        }
    }

    fn say_of_policy(&self, policy: Policy) {
        let options: BTreeSet<&str> = Policy::ALL
            .iter()
            .flat_map(|of| of.facts().options)
            .copied()
            .collect();
        let goes_by = |policy: &Policy, id: &str| policy.facts().options.contains(&id);
        for id in options.into_iter().filter(|id| !goes_by(&policy, id)) {
            if !self.has(id) {
                continue;
            }
            let of = Policy::ALL.iter().filter(|policy| goes_by(policy, id));
            let names: Vec<&str> = of.map(|policy| policy.name()).collect();
            output::say(&format!(
                "warning: --{} changes nothing with --policy {}; it is for {}",
                id.replace('_', "-"),
                policy.name(),
                names.join(", "),
            ));
        }
    }
}
