//! Is the pack that an earlier run prepared still good?

use crate::report::output::{self, Counting};
use crate::run::calibrate::{CalibrationExtent, calibrate};
use foveal_media::VideoInput;
use foveal_media::pack::name_claim::{IfTaken, NameClaim};
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::write_calibrated;
use foveal_media::prepare::{
    PreparationPlan as Plan, PrepareSettings, Progress, Remarks, pack_identity_of, prepare,
};
use std::path::Path;

/// How `source` would be prepared.
pub(crate) fn plan_of(source: &Path, settings: &PrepareSettings) -> anyhow::Result<Plan> {
    let info = VideoInput::open_with(source, settings.reading())?
        .info()
        .clone();
    Ok(Plan::new(source, &info, settings)?)
}

/// The plan of the pack that is there, when the same preparation would make it again: the same
/// source, settings and program.
pub(crate) fn kept(source: &Path, pack: &Path, settings: &PrepareSettings) -> Option<Plan> {
    let plan = plan_of(source, settings).ok()?;
    let found = PackFile::open(pack).ok()?;
    let wanted = pack_identity_of(source, &plan).ok()?;
    let is_it = found.pack().description().identity == Some(wanted);
    is_it.then_some(plan)
}

/// Calibrates a pack in its own place, where it has no calibration and can have one.
pub(crate) fn calibrate_in_place(pack: &Path, extent: CalibrationExtent) -> anyhow::Result<()> {
    if PackFile::open(pack)?.calibration()?.is_some() {
        return Ok(());
    }
    output::say(&format!("{}: is being calibrated", pack.display()));
    let found = calibrate(pack, extent, output::jobs(None)?)?;
    if let Some(found) = found {
        let claim = NameClaim::of(pack, IfTaken::Replace)?;
        write_calibrated(pack, claim, &found.calibration)?;
    }
    Ok(())
}

/// Says what a person should know of the preparation of `source`, warnings first.
pub(crate) fn remark(source: &Path, remarks: &Remarks) {
    warn(source, &remarks.warnings);
    for note in &remarks.notes {
        output::say(&format!("{}: {note}", source.display()));
    }
}

/// Says what matters of a file.
pub(crate) fn warn(file: &Path, warnings: &[String]) {
    for warning in warnings {
        output::say(&format!("warning: {}: {warning}", file.display()));
    }
}

/// Prepares as planned, with a progress bar of `length` frames.
pub(crate) fn write_pack(
    source: &Path,
    pack: &Path,
    plan: &Plan,
    length: Option<u64>,
) -> anyhow::Result<()> {
    output::say(&format!("{}: is being prepared", source.display()));
    remark(source, &plan.remarks);
    let bar = output::bar(length, Counting::Frames);
    let mut note = |progress: Progress| bar.set_position(u64::from(progress.frames));
    let prepared = prepare(source, pack, plan, &mut note);
    bar.finish_and_clear();
    warn(source, &prepared?.warnings);
    Ok(())
}
