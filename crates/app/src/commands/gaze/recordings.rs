//! Which recordings and which preset does a gaze command work on?

use crate::gaze_source::{GazeFile, GazeForm, preset_of};
use crate::report::output::{WrongUsage, spare_inputs};
use anyhow::{Context, bail};
use clap::Args;
use foveal_eval::gaze::head_fit::HeadFit;
use foveal_eval::gaze::head_from_trace::recording_from_trace;
use foveal_eval::gaze::head_protocol::leave_one_out;
use foveal_eval::gaze::head_recording::HeadRecording;
use std::path::{Path, PathBuf};

/// Recordings of eyes and head.
#[derive(Clone, Debug, Args)]
pub(crate) struct Recordings {
    /// Recordings of eyes and head: traces with head columns, or CSV at 100 Hz as published with
    /// Hu et al. 2019 (SGaze).
    #[arg(long, value_name = "FILE", num_args = 1.., required = true)]
    data: Vec<PathBuf>,
}

impl Recordings {
    /// Each file's name as it was given, in order.
    pub(crate) fn names(&self) -> impl Iterator<Item = String> {
        self.data.iter().map(|file| file.display().to_string())
    }

    /// Refuses to write where one of them lies.
    pub(crate) fn spared_by(&self, out: &Path) -> Result<(), WrongUsage> {
        spare_inputs(out, self.data.iter().map(PathBuf::as_path))
    }

    /// Reads all of them.
    pub(crate) fn read(&self) -> anyhow::Result<Vec<HeadRecording>> {
        self.data.iter().map(|file| read(file)).collect()
    }
}

/// Reads a trace that knows eyes and head, or a recording of Hu et al. 2019.
fn read(path: &Path) -> anyhow::Result<HeadRecording> {
    let name = path.display();
    if path.is_dir() {
        bail!("{name}: is a folder; give the recordings in it");
    }
    match GazeFile::read(path, GazeForm::Recording)? {
        GazeFile::Recording(recording) => Ok(recording),
        GazeFile::Trace(trace) => recording_from_trace(&trace).with_context(|| {
            format!(
                "{name}: never knows eyes and head together; record with a source that sends \
                 head_yaw_deg and head_pitch_deg"
            )
        }),
    }
}

/// Which law predicts the gaze.
#[derive(Clone, Debug, Args)]
pub(crate) struct PresetOptions {
    /// `free-viewing`, `search` or a file that `gaze fit head` wrote.
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "free-viewing")]
    preset: String,
    /// For each recording, fit the law and the mean on all others.
    #[arg(long, conflicts_with = "preset")]
    leave_one_out: bool,
}

impl PresetOptions {
    /// One law per recording, with the mean gaze it is compared to.
    pub(crate) fn fits(&self, recordings: &[HeadRecording]) -> anyhow::Result<Vec<HeadFit>> {
        if !self.leave_one_out {
            let fit = HeadFit::shipped(preset_of(&self.preset, false)?);
            return Ok(vec![fit; recordings.len()]);
        }
        if recordings.len() < 2 {
            bail!(WrongUsage(
                "--leave-one-out needs two recordings; give more files to --data".to_owned()
            ));
        }
        Ok(leave_one_out(recordings))
    }
}
