//! Is the pack that an earlier run prepared still good?

use crate::output::{self, Counting};
use foveal_core::asset::pack::Description;
use foveal_media::VideoInput;
use foveal_media::pack_file::PackFile;
use foveal_media::prepare::{Plan, PrepareSettings, Progress, prepare};
use std::path::Path;

/// How `source` would be prepared.
pub(crate) fn plan_of(source: &Path, settings: &PrepareSettings) -> anyhow::Result<Plan> {
    let info = VideoInput::open(source)?.info().clone();
    Ok(Plan::new(source, &info, settings)?)
}

/// The plan of the pack that is there, when it would be prepared the same way again: source of the
/// same name, size and bytes and not newer, program of the same version.
pub(crate) fn kept(source: &Path, pack: &Path, settings: &PrepareSettings) -> Option<Plan> {
    let changed = |path: &Path| path.metadata().and_then(|about| about.modified()).ok();
    if changed(source)? > changed(pack)? {
        return None;
    }
    let (plan, file) = (plan_of(source, settings).ok()?, PackFile::open(pack).ok()?);
    let found = file.pack().description();
    let expected = Description {
        frames: found.frames,
        tables: found.tables.clone(),
        ..plan.description.clone()
    };
    (*found == expected).then_some(plan)
}

/// Prepares as planned, with a progress bar of `length` frames.
pub(crate) fn write_pack(
    source: &Path,
    pack: &Path,
    plan: &Plan,
    length: Option<u64>,
) -> anyhow::Result<()> {
    output::say(&format!("{}: is being prepared", source.display()));
    for note in &plan.notes {
        output::say(&format!("{}: {note}", source.display()));
    }
    let bar = output::bar(length, Counting::Frames);
    let mut note = |progress: Progress| bar.set_position(u64::from(progress.frames));
    let prepared = prepare(source, pack, plan, &mut note);
    bar.finish_and_clear();
    for note in prepared?.notes {
        output::say(&format!("{}: {note}", source.display()));
    }
    Ok(())
}
