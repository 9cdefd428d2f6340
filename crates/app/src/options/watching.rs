//! What is known of the viewer, and what can arrive in time?

use crate::gaze_source::ViewerModel;
use crate::options::link::{Link, parse_delay, parse_link};
use crate::options::preset::PlayPresets;
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
    #[command(flatten)]
    pub(crate) presets: PlayPresets,
}

impl Watching {
    /// What brings the pack; without a limit unless one was given.
    pub(crate) fn link(&self) -> Link {
        self.link.unwrap_or_default()
    }

    /// The viewer, for whom gaze is expected.
    pub(crate) fn viewer(&self) -> anyhow::Result<ViewerModel> {
        Ok(ViewerModel {
            preset: self.presets.head_gaze()?,
            late: Seconds(self.late.0 + self.link().delay.0),
        })
    }

    /// The files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.presets.files()
    }
}
