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
    /// The link between pack and viewer, as RATE or RATE,DELAY: 8mbit or 8mbit,30ms. A rate is in
    /// kbit, mbit or gbit a second (kB/s and MB/s too), or 3g, 4g, 5g: 2, 40, 67 mbit; a delay in
    /// ms or s. It limits the units that uniform, eccentricity and perceptual fetch beyond the
    /// coarsest level, which is always sent (default: no limit).
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
