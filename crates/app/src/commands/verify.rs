//! Is every byte of a pack as it was written?

use crate::report::damage::listed;
use crate::report::output::{self, WrongUsage};
use anyhow::anyhow;
use clap::Args;
use foveal_core::content::opened::ContentFacts;
use foveal_core::pack::unit::UnitId;
use foveal_core::units::counted;
use foveal_media::pack::pack::Pack;
use foveal_media::pack::scene_file::SceneFile;
use foveal_scene::cracks::{CutReport, CutTrial, check_cuts};
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
    #[serde(flatten)]
    cuts: Option<Cuts>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct Cuts {
    source_odd_edges: u64,
    odd_edges_max: u64,
    cuts: u32,
    orders: u32,
    levels_in_cut_min: u32,
}

impl VerifyArgs {
    fn tries(&self) -> bool {
        self.cuts > 0 || self.orders > 0
    }

    /// Refuses options that would do nothing.
    fn check(&self, about: &ContentFacts) -> Result<(), WrongUsage> {
        let tries = self.tries();
        if !about.is_entered && (tries || self.ignore_prerequisites) {
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
    let file = Pack::open(&args.pack)?;
    args.check(file.facts())?;
    let bar = output::bar(Some(file.bytes()), output::Counting::Bytes);
    let damage = file.verify(|done, _| bar.set_position(done));
    bar.finish_and_clear();
    let is_whole = damage.is_empty();
    let cut = file.scene().filter(|_| is_whole && args.tries());
    let cuts = cut.map(|scene| cuts_of(scene, args)).transpose()?;
    let verified = Verified {
        ok: is_whole && cuts.is_none_or(|it| it.odd_edges_max <= it.source_odd_edges),
        bytes: file.bytes(),
        units: file.units(),
        damage: listed(&damage),
        damaged_places: damage.places(),
        cuts,
    };
    let told = cuts.map_or_else(String::new, |it| {
        format!(
            "; {} and {}: {} at most {}, the source has {}",
            counted(it.cuts, "cut"),
            counted(it.orders, "order"),
            match it.odd_edges_max <= it.source_odd_edges {
                true => "no crack,",
                false => "cracks,",
            },
            counted(it.odd_edges_max, "odd edge"),
            it.source_odd_edges
        )
    });
    if verified.ok {
        let text = format!(
            "{}: whole, {} bytes checked{told}",
            args.pack.display(),
            file.bytes()
        );
        return output::result(args.json, &verified, &text);
    }
    let error = match is_whole {
        true if args.ignore_prerequisites => anyhow!(
            "{}: not closed{told}; so cracks are found, as they should be without prerequisites: \
             this says nothing against the pack",
            args.pack.display()
        ),
        true => anyhow!(
            "{}: not closed{told}; prepare it again",
            args.pack.display()
        ),
        false => anyhow!(
            "{}: {}; copy the pack again, or prepare it again\n  {}",
            args.pack.display(),
            counted(damage.places(), "damaged place"),
            verified.damage.join("\n  ")
        ),
    };
    output::result_that_fails(args.json, &verified, "", error)
}

fn cuts_of(file: &SceneFile, args: &VerifyArgs) -> anyhow::Result<Cuts> {
    let pack = file.pack();
    let rows: Vec<_> = pack
        .units()
        .map(|it| (pack.level_of(it), pack.row(it).clone()))
        .collect();
    let mut payload_of = |unit: UnitId| file.read_mesh(unit).map_err(anyhow::Error::from);
    let trial = CutTrial {
        cuts: args.cuts,
        orders: args.orders,
        seed: 1,
        ignore_prerequisites: args.ignore_prerequisites,
    };
    let CutReport {
        source_odd_edges,
        odd_edges_max,
        cuts,
        orders,
        levels_in_cut_min,
    } = check_cuts(&rows, &mut payload_of, &trial)?;
    Ok(Cuts {
        source_odd_edges,
        odd_edges_max,
        cuts,
        orders,
        levels_in_cut_min,
    })
}
