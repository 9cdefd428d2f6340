//! How does a pack that was made before learn which score its content has at which bound?

use crate::commands::info::{CalibrationInfo, PackInfo};
use crate::report::output::{self, WrongUsage};
use crate::run::calibrate::{CalibrationExtent, calibrate};
use crate::run::pack_place::{if_taken, pack_at};
use anyhow::bail;
use clap::Args;
use foveal_media::pack::name_claim::NameClaim;
use foveal_media::pack::pack::Pack;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::write_calibrated;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Clone, Debug, Args)]
pub(crate) struct CalibrateArgs {
    /// A pack of video.
    pack: PathBuf,
    /// The calibrated copy to write.
    #[arg(long, value_name = "PACK")]
    out: PathBuf,
    /// Test five gazes at all densities and bounds, however long it takes.
    #[arg(long)]
    thorough: bool,
    /// Threads (default: all cores).
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// Replace another pack at --out, which stays until the new one is whole.
    #[arg(long)]
    force: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct CalibrateResult<'a> {
    calibration: Option<&'a CalibrationInfo>,
    target_pixels_share: Option<f64>,
    target_policy: Option<&'static str>,
    calibrate_s: f64,
    bytes: u64,
}

pub(crate) fn run(args: &CalibrateArgs) -> anyhow::Result<()> {
    let pack = Pack::open(&args.pack)?;
    let Some(old) = pack.video() else {
        bail!(WrongUsage(format!(
            "{}: is a scene; only packs of video can be calibrated",
            args.pack.display()
        )));
    };
    if old.signatures()?.is_none() {
        bail!(
            "{}: has no signatures, so no levels can be chosen for a score; prepare it again \
             from its source",
            args.pack.display()
        );
    }
    let is_same = |one: &PathBuf, other: &PathBuf| match (one.canonicalize(), other.canonicalize())
    {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    };
    if is_same(&args.pack, &args.out) {
        bail!(WrongUsage(format!(
            "--out {}: is the pack itself; choose another name",
            args.out.display()
        )));
    }
    let there = pack_at(&args.out)?;
    if there.is_some() && !args.force {
        bail!(WrongUsage(format!(
            "--out {}: is there already; choose another name, or give --force to replace it",
            args.out.display()
        )));
    }
    let claim = NameClaim::of(&args.out, if_taken(there.as_ref()))?;
    let extent = match args.thorough {
        true => CalibrationExtent::Thorough,
        false => CalibrationExtent::Usual,
    };
    say_begun(args, old.calibration().ok().flatten().is_some());
    let begun = Instant::now();
    let Some(found) = calibrate(&args.pack, extent, output::jobs(args.jobs)?)? else {
        bail!(
            "{}: its pictures are too small for a score, so nothing can be calibrated",
            args.pack.display()
        );
    };
    if let Some(left_out) = &found.left_out {
        output::say(&format!("{}: {left_out}", args.pack.display()));
    }
    write_calibrated(&args.pack, claim, &found.calibration)?;
    let calibrate_s = begun.elapsed().as_secs_f64();
    let pack = PackInfo::new(&PackFile::open(&args.out)?)?;
    let at_target = pack
        .calibration
        .as_ref()
        .and_then(CalibrationInfo::at_default_target);
    let done = CalibrateResult {
        calibration: pack.calibration.as_ref(),
        target_pixels_share: at_target.map(|(_, share)| share),
        target_policy: at_target.map(|(policy, _)| policy),
        calibrate_s,
        bytes: pack.bytes,
    };
    let text = format!(
        "{}: {calibrate_s:.1} s\n{}",
        args.out.display(),
        pack.text().trim_end()
    );
    output::result(args.json, &done, &text)
}

fn say_begun(args: &CalibrateArgs, is_calibrated: bool) {
    if is_calibrated {
        output::say(&format!(
            "{}: is calibrated already; the new pack gets a new table",
            args.pack.display()
        ));
    }
    if !args.thorough {
        output::say(&format!(
            "{}: measures how the score falls as detail is dropped, which takes about a minute of \
             CPU time",
            args.pack.display()
        ));
    }
}
