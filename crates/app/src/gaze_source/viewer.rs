//! What is assumed about a viewer?

use crate::report::output::{WrongUsage, read_settings};
use anyhow::{Context, bail};
use foveal_core::gaze::head_prediction::saturating::HeadGazePreset;
use foveal_core::units::Seconds;
use std::path::Path;

/// How a viewer is watched.
#[derive(Clone, Debug)]
pub(crate) struct ViewerModel {
    /// How their gaze follows their head.
    pub(crate) preset: HeadGazePreset,
    /// How long before a picture is shown its gaze must be known.
    pub(crate) late: Seconds,
}

impl Default for ViewerModel {
    /// A viewer who looks around freely, watched without delay.
    fn default() -> Self {
        Self {
            preset: HeadGazePreset::free_viewing(),
            late: Seconds(0.0),
        }
    }
}

/// The preset of a name, or of a file that `foveal gaze fit head` wrote; `plays` says whether a
/// published system could have been named in its place.
pub(crate) fn preset_of(choice: &str, plays: bool) -> anyhow::Result<HeadGazePreset> {
    if let Some(preset) = HeadGazePreset::named(choice) {
        return Ok(preset);
    }
    let path = Path::new(choice);
    if !path.exists() {
        let system = match plays {
            true => "; or kastner-2016, to choose as that system does",
            false => "",
        };
        bail!(WrongUsage(format!(
            "--preset is {choice}; give free-viewing, search or a file that is there{system}"
        )));
    }
    let text = read_settings(path, "a preset")?;
    let preset: HeadGazePreset = toml::from_str(&text).with_context(|| choice.to_owned())?;
    preset.checked().with_context(|| choice.to_owned())
}
