//! What of an older run lies in a folder, and makes room for a new one?

use crate::report::output::{self, spare_inputs};
use anyhow::Context;
use foveal_core::units::counted;
use foveal_media::plain_file::{open_folder, open_plain};
use std::collections::BTreeSet;
use std::fs::TryLockError;
use std::io::{BufRead, BufReader, Read};
use std::path::{Component, Path, PathBuf};

/// The log of a run.
pub(crate) const LOG: &str = "session.jsonl";
/// The figures of its frames.
pub(crate) const TABLE: &str = "frames.csv";
/// Its pictures as one video.
pub(crate) const VIDEO: &str = "frames.mkv";
/// Longest first line of a log that is looked at, in bytes.
const MOST_HEAD: u64 = 1 << 22;

/// Name of a picture of a run.
pub(crate) fn picture_name(number: u32) -> String {
    format!("frame_{number:05}.png")
}

/// Keeps a folder for this process until it ends, so that no other run writes there meanwhile.
/// Where a system locks no folders, nothing is kept.
pub(crate) fn hold(out: &Path) -> anyhow::Result<()> {
    let Ok(folder) = open_folder(out) else {
        return Ok(());
    };
    match folder.try_lock() {
        Err(TryLockError::WouldBlock) => anyhow::bail!(
            "--out {}: another run writes there now; wait until it is done, or give another folder",
            out.display()
        ),
        Ok(()) | Err(TryLockError::Error(_)) => {
            // The system lets go of the lock with the process.
            std::mem::forget(folder);
            Ok(())
        }
    }
}

/// Removes what an older run left in `out` and in its folders of panels, or of these, and says so
/// first, so that two runs never lie in one folder. Refuses where that is one of the `inputs`.
pub(crate) fn make_room(out: &Path, panels: &[&str], inputs: &[&Path]) -> anyhow::Result<()> {
    let mut panels: BTreeSet<String> = panels.iter().map(|id| (*id).to_owned()).collect();
    panels.extend(panels_of(&out.join(LOG)));
    let mut files = files_of_run(out);
    for panel in &panels {
        files.extend(files_of_run(&out.join(panel)));
    }
    for file in &files {
        spare_inputs(file, inputs.iter().copied())?;
    }
    if files.is_empty() {
        return Ok(());
    }
    output::say(&format!(
        "{}: overwriting an earlier run of {}",
        out.display(),
        counted(files.len(), "file")
    ));
    // The log, which names the panels, goes last.
    files.sort_by_key(|file| file.file_name().is_some_and(|name| name == LOG));
    for file in &files {
        std::fs::remove_file(file)
            .with_context(|| format!("{}: of an older run, cannot be removed", file.display()))?;
    }
    for panel in &panels {
        // A folder with anything else in it stays.
        let _ = std::fs::remove_dir(out.join(panel));
    }
    Ok(())
}

/// Removes the pictures that an older run left in these folders of `out`, and says so.
pub(crate) fn clear_pictures<'a>(
    out: &Path,
    folders: impl IntoIterator<Item = &'a str>,
) -> anyhow::Result<()> {
    let mut files = Vec::new();
    for folder in folders.into_iter().filter(|name| is_plain_name(name)) {
        files.extend(files_of_run(&out.join(folder)));
    }
    if files.is_empty() {
        return Ok(());
    }
    output::say(&format!(
        "{}: {} of an older run removed",
        out.display(),
        counted(files.len(), "picture")
    ));
    for file in &files {
        std::fs::remove_file(file)
            .with_context(|| format!("{}: of an older run, cannot be removed", file.display()))?;
    }
    Ok(())
}

/// How many other pictures than these lie in a folder.
pub(crate) fn other_pictures(out: &Path, own: &[PathBuf]) -> usize {
    let entries = std::fs::read_dir(out).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path());
    let is_picture = |path: &PathBuf| path.extension().is_some_and(|it| it == "png");
    paths
        .filter(|path| is_picture(path) && !own.contains(path))
        .count()
}

/// The files of a run that lie in a folder.
fn files_of_run(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_file = |entry: &std::fs::DirEntry| entry.file_type().is_ok_and(|kind| !kind.is_dir());
    let entries = entries.filter(is_file);
    let entries = entries.filter(|entry| is_of_run(&entry.file_name().to_string_lossy()));
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.sort();
    files
}

/// Whether a run gives its files such names.
fn is_of_run(name: &str) -> bool {
    let name = name.strip_suffix(".partial").unwrap_or(name);
    let number = name.strip_prefix("frame_");
    let number = number.and_then(|rest| rest.strip_suffix(".png"));
    let is_number = |digits: &str| digits.len() >= 5 && digits.bytes().all(|b| b.is_ascii_digit());
    [LOG, TABLE, VIDEO].contains(&name) || number.is_some_and(is_number)
}

/// The panels that a log names, as folders next to it.
fn panels_of(log: &Path) -> Vec<String> {
    #[derive(serde::Deserialize)]
    struct Head {
        #[serde(default)]
        panels: Vec<Panel>,
    }
    #[derive(serde::Deserialize)]
    struct Panel {
        id: String,
    }
    let mut head = Vec::new();
    let plain = open_plain(log).ok();
    let read = plain.map(|(file, _)| {
        let mut start = BufReader::new(file).take(MOST_HEAD);
        start.read_until(b'\n', &mut head)
    });
    let head = read.and_then(|_| serde_json::from_slice::<Head>(&head).ok());
    let panels = head.map_or_else(Vec::new, |head| head.panels);
    let ids = panels.into_iter().map(|panel| panel.id);
    ids.filter(|id| is_plain_name(id)).collect()
}

/// Whether it names something in a folder, and nothing elsewhere.
fn is_plain_name(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(only)), None) if only == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_has_its_own_names_and_takes_no_others() {
        for name in [
            LOG,
            TABLE,
            VIDEO,
            "frame_00000.png",
            "frame_123456.png.partial",
        ] {
            assert!(is_of_run(name), "{name}");
        }
        for name in [
            "frame_1.png",
            "frame_0000a.png",
            "frame_00000.jpg",
            "frames.csv.bak",
            "a.png",
        ] {
            assert!(!is_of_run(name), "{name}");
        }
        assert!(is_plain_name("left") && is_plain_name("P 1"));
        for name in ["", ".", "..", "../x", "a/b", "/a", "a/"] {
            assert!(!is_plain_name(name), "{name}");
        }
    }
}
