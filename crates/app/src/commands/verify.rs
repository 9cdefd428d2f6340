//! Is every byte of a pack as it was written?

use crate::commands::scene::verify::{Trials, run as verify_scene};
use crate::report::damage::listed;
use crate::report::output::{self, WrongUsage};
use anyhow::anyhow;
use clap::Args;
use foveal_core::units::counted;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::scene_file::is_scene_pack;
use serde::Serialize;
use std::path::PathBuf;

/// Most cuts and orders: minutes to hours of them.
const MOST_TRIES: i64 = 10_000;

#[derive(Clone, Debug, Args)]
pub(crate) struct VerifyArgs {
    /// The pack.
    pack: PathBuf,
    /// Scenes: cut so many times as an eye would somewhere, and count cracks.
    #[arg(long, value_name = "N", default_value_t = 0,
        value_parser = clap::value_parser!(u32).range(..=MOST_TRIES))]
    cuts: u32,
    /// Scenes: let units arrive in so many random orders, and count cracks on the way.
    #[arg(long, value_name = "N", default_value_t = 0,
        value_parser = clap::value_parser!(u32).range(..=MOST_TRIES))]
    orders: u32,
    /// Scenes: show units whose prerequisites are missing; that there are cracks then shows that
    /// they would be found.
    #[arg(long)]
    ignore_prerequisites: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Verified {
    ok: bool,
    bytes: u64,
    units: usize,
    damage: Vec<String>,
    damaged_places: u64,
}

impl VerifyArgs {
    /// Refuses options that would do nothing.
    fn check(&self, is_scene: bool) -> Result<(), WrongUsage> {
        let tries = self.cuts > 0 || self.orders > 0;
        if !is_scene && (tries || self.ignore_prerequisites) {
            let what = "--cuts, --orders, --ignore-prerequisites: are about scenes, and this is a \
                        pack of video; leave them out";
            return Err(WrongUsage(what.to_owned()));
        }
        if self.ignore_prerequisites && !tries {
            let what = "--ignore-prerequisites: nothing is cut; give --cuts N or --orders N too";
            return Err(WrongUsage(what.to_owned()));
        }
        Ok(())
    }
}

pub(crate) fn run(args: &VerifyArgs) -> anyhow::Result<()> {
    let is_scene = is_scene_pack(&args.pack);
    args.check(is_scene)?;
    if is_scene {
        let trials = Trials {
            cuts: args.cuts,
            orders: args.orders,
            ignore_prerequisites: args.ignore_prerequisites,
        };
        return verify_scene(&args.pack, &trials, args.json);
    }
    let file = PackFile::open(&args.pack)?;
    let bar = output::bar(Some(file.bytes()), output::Counting::Bytes);
    let damage = file.verify(|done, _| bar.set_position(done));
    bar.finish_and_clear();
    let found = damage.places();
    let verified = Verified {
        ok: damage.is_empty(),
        bytes: file.bytes(),
        units: file.pack().units().count(),
        damage: listed(&damage),
        damaged_places: damage.places(),
    };
    if verified.ok {
        let text = format!(
            "{}: whole, {} bytes checked",
            args.pack.display(),
            verified.bytes
        );
        return output::result(args.json, &verified, &text);
    }
    let error = anyhow!(
        "{}: {}; copy the pack again, or prepare it again\n  {}",
        args.pack.display(),
        counted(found, "damaged place"),
        verified.damage.join("\n  ")
    );
    output::result_that_fails(args.json, &verified, "", error)
}
