//! Which options that were given change nothing?

use crate::options::policy_choice::PolicyChoice;
use clap::ArgMatches;
use clap::parser::ValueSource;
use foveal_core::content::policy::Policy;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::scene_file::is_scene_pack;
use std::collections::BTreeSet;
use std::path::PathBuf;

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

/// A line for each option that was given to `simulate` or `select` for another content or policy.
pub(crate) fn unused_options(matches: &ArgMatches) -> Vec<String> {
    let Some((name @ ("simulate" | "select"), given)) = matches.subcommand() else {
        return Vec::new();
    };
    let of_content = unused_field(given).map(str::to_owned).into_iter();
    of_content.chain(unused_of_policy(name, given)).collect()
}

/// What is said of a field of view that was given for flat content, whose screen sets it.
fn unused_field(given: &ArgMatches) -> Option<&'static str> {
    let is_known = given.try_contains_id("fov").is_ok();
    let is_given = is_known && given.value_source("fov") == Some(ValueSource::CommandLine);
    let is_flat = || match given.try_get_raw("projection") {
        Ok(Some(mut projection)) => projection.any(|it| it == "flat"),
        _ => {
            let pack = given.try_get_one::<PathBuf>("pack").ok().flatten();
            let file = pack.and_then(|pack| PackFile::open(pack).ok());
            file.is_some_and(|file| !file.pack().description().projection.surrounds())
        }
    };
    (is_given && is_flat()).then_some(
        "warning: --fov changes nothing for flat content, whose screen sets how wide it is; give \
         --screen INCHES,METRES",
    )
}

fn unused_of_policy(name: &str, given: &ArgMatches) -> Vec<String> {
    // A preset brings its own policy, which the content decides.
    if given.value_source("preset") == Some(ValueSource::CommandLine) {
        return Vec::new();
    }
    let pack = given.try_get_one::<PathBuf>("pack").ok().flatten();
    let is_scene = name == "simulate" && pack.is_some_and(|pack| is_scene_pack(pack));
    let policy = given.get_one::<PolicyChoice>("policy");
    let policy = policy.and_then(|choice| choice.named());
    let is_given = |id| {
        let known = given.try_contains_id(id).is_ok();
        known && given.value_source(id) == Some(ValueSource::CommandLine)
    };
    let is_of_acuity = ["slope", "acuity", "safety_disc"].into_iter().any(is_given);
    let has_panels = is_given("panels");
    let of_tiles = OF_TILES.into_iter().filter(|id| is_scene && is_given(id));
    let of_tiles = of_tiles.filter(|id| *id != "eye" || !has_panels);
    let of_tiles = of_tiles.map(|id| {
        let option = id.replace('_', "-");
        format!("warning: --{option} changes nothing for a scene; it is for video")
    });
    let is_free_scene = is_scene && !["link", "budget"].into_iter().any(is_given);
    let policy = policy.unwrap_or(match is_of_acuity || is_free_scene || name == "select" {
        true => Policy::Acuity,
        false => Policy::Perceptual,
    });
    let options: BTreeSet<&str> = Policy::ALL
        .iter()
        .flat_map(|of| of.facts().options)
        .copied()
        .collect();
    let goes_by = |policy: &Policy, id: &str| policy.facts().options.contains(&id);
    let unused = options.into_iter().filter(|id| !goes_by(&policy, id));
    unused
        .filter(|id| is_given(id))
        .map(|id| {
            let of = Policy::ALL.iter().filter(|policy| goes_by(policy, id));
            let names: Vec<&str> = of.map(|policy| policy.name()).collect();
            format!(
                "warning: --{} changes nothing with --policy {}; it is for {}",
                id.replace('_', "-"),
                policy.name(),
                names.join(", "),
            )
        })
        .chain(of_tiles)
        .collect()
}
