//! Is the pack of a scene as it was written, and closed however it arrives?

use crate::report::damage::listed;
use crate::report::output;
use anyhow::anyhow;
use foveal_core::pack::unit::UnitId;
use foveal_core::units::counted;
use foveal_media::pack::scene_file::SceneFile;
use foveal_scene::cracks::{CutReport, CutTrial, check_cuts};
use serde::Serialize;
use std::path::Path;

/// What is tried of cuts and orders.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trials {
    pub(crate) cuts: u32,
    pub(crate) orders: u32,
    pub(crate) ignore_prerequisites: bool,
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

pub(crate) fn run(path: &Path, trials: &Trials, json: bool) -> anyhow::Result<()> {
    let file = SceneFile::open(path)?;
    let bar = output::bar(Some(file.bytes()), output::Counting::Bytes);
    let damage = file.verify(|done, _| bar.set_position(done));
    bar.finish_and_clear();
    let is_whole = damage.is_empty();
    let tries = is_whole && (trials.cuts > 0 || trials.orders > 0);
    let cuts = tries.then(|| cuts_of(&file, trials)).transpose()?;
    let verified = Verified {
        ok: is_whole && cuts.is_none_or(|it| it.odd_edges_max <= it.source_odd_edges),
        bytes: file.bytes(),
        units: file.pack().len(),
        damage: listed(&damage),
        damaged_places: damage.places(),
        cuts,
    };
    let told = cuts.map_or_else(String::new, |it| {
        format!(
            "; {} and {}: at most {}, the source has {}",
            counted(it.cuts, "cut"),
            counted(it.orders, "order"),
            counted(it.odd_edges_max, "odd edge"),
            it.source_odd_edges
        )
    });
    if verified.ok {
        let text = format!(
            "{}: whole, {} bytes checked{told}",
            path.display(),
            file.bytes()
        );
        return output::result(json, &verified, &text);
    }
    let error = match is_whole {
        true if trials.ignore_prerequisites => anyhow!(
            "{}: not closed{told}; so cracks are found, as they should be without prerequisites: \
             this says nothing against the pack",
            path.display()
        ),
        true => anyhow!("{}: not closed{told}; prepare it again", path.display()),
        false => anyhow!(
            "{}: {}; copy the pack again, or prepare it again\n  {}",
            path.display(),
            counted(damage.places(), "damaged place"),
            verified.damage.join("\n  ")
        ),
    };
    output::result_that_fails(json, &verified, "", error)
}

fn cuts_of(file: &SceneFile, trials: &Trials) -> anyhow::Result<Cuts> {
    let pack = file.pack();
    let rows: Vec<_> = pack
        .units()
        .map(|it| (pack.level_of(it), pack.row(it).clone()))
        .collect();
    let mut payload_of = |unit: UnitId| file.read_mesh(unit).map_err(anyhow::Error::from);
    let trial = CutTrial {
        cuts: trials.cuts,
        orders: trials.orders,
        seed: 1,
        ignore_prerequisites: trials.ignore_prerequisites,
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
