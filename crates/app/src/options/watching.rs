//! What is known of the viewer, and what can arrive in time?

use crate::gaze_source::{ViewerModel, preset_of};
use crate::options::link::{Link, parse_delay, parse_link};
use crate::options::preset::SystemPreset;
use crate::report::output::WrongUsage;
use anyhow::bail;
use clap::Args;
use foveal_core::units::Seconds;
use std::path::Path;

/// What is known of the viewer, and what can arrive in time.
#[derive(Clone, Debug, Args)]
pub(crate) struct Watching {
    /// RATE[,DELAY] between the pack and the viewer, as 4g,30ms or 8mbit (3g, 4g, 5g are 2, 40, 67
    /// Mbit/s): what uniform, eccentricity and perceptual may spend on finer tiles than those of
    /// the coarsest level, which is always sent (default: no limit).
    #[arg(long, value_name = "L", value_parser = parse_link)]
    pub(crate) link: Option<Link>,
    /// Latency from gaze to display, in ms; the link's delay adds to it. Levels are chosen for the
    /// gaze that is expected by then.
    #[arg(long, value_name = "MS", value_parser = parse_delay, default_value = "0")]
    late: Seconds,
    /// How gaze follows the head: free-viewing (default), search or a file that `gaze fit head`
    /// wrote; or, beside that, a published system to choose as: kastner-2016.
    #[arg(long, value_name = "NAME|FILE.toml")]
    preset: Vec<String>,
}

impl Watching {
    /// What brings the pack; without a limit unless one was given.
    pub(crate) fn link(&self) -> Link {
        self.link.unwrap_or_default()
    }

    /// The viewer, for whom gaze is expected.
    pub(crate) fn viewer(&self) -> anyhow::Result<ViewerModel> {
        let is_of_viewer = |name: &&String| SystemPreset::named(name).is_none();
        let mut of_viewer = self.preset.iter().filter(is_of_viewer);
        let preset = of_viewer.next().map_or("free-viewing", String::as_str);
        if let Some(second) = of_viewer.next() {
            bail!(WrongUsage(format!(
                "--preset: gaze follows the head as in {preset} or as in {second}, not both"
            )));
        }
        Ok(ViewerModel {
            preset: preset_of(preset)?,
            late: Seconds(self.late.0 + self.link().delay.0),
        })
    }

    /// The files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.preset.iter().map(Path::new)
    }

    /// The published system that was asked for.
    pub(crate) fn system(&self) -> Option<SystemPreset> {
        self.preset
            .iter()
            .find_map(|name| SystemPreset::named(name))
    }
}
