//! What is taken for granted about a viewer?

use crate::report::output::read_settings;
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
    /// Somebody who looks around freely, watched without delay.
    fn default() -> Self {
        Self {
            preset: HeadGazePreset::free_viewing(),
            late: Seconds(0.0),
        }
    }
}

/// The preset of a name, or of a file that `foveal gaze fit head` wrote.
pub(crate) fn preset_of(choice: &str) -> anyhow::Result<HeadGazePreset> {
    if let Some(preset) = HeadGazePreset::named(choice) {
        return Ok(preset);
    }
    let path = Path::new(choice);
    if !path.exists() {
        bail!(
            "--preset is {choice}; give free-viewing, search or a file that is there, or, where \
             a published system is chosen, kastner-2016"
        );
    }
    let text = read_settings(path, "a preset")?;
    let preset: HeadGazePreset = toml::from_str(&text).with_context(|| choice.to_owned())?;
    preset.checked().with_context(|| choice.to_owned())
}
