//! Which labelled recordings does a command work on?

use crate::report::output::open_file;
use foveal_eval::gaze::labelled::{LabelScreen, read_labelled};
use foveal_eval::gaze::recording::Recording;
use std::io::BufReader;
use std::path::Path;

/// Reads a labelled file.
pub(super) fn read_recording(
    path: &Path,
    screen: Option<&LabelScreen>,
) -> anyhow::Result<Recording> {
    let name = path.display().to_string();
    let file = open_file(path, "labelled recording")?;
    Ok(read_labelled(&name, &mut BufReader::new(file), screen)?)
}
