//! What does a file record about eyes and head?
//!
//! One reader, whichever command asks: a trace, or a recording as published with Hu et al. 2019.

use crate::report::output::{open_file, told};
use anyhow::{Context, anyhow};
use foveal_core::gaze::read::trace::{MAX_LINE_BYTES, Trace, TraceError, TraceReader};
use foveal_core::gaze::read::tracker_table::{TrackerForm, TrackerReader};
use foveal_eval::gaze::head_recording::HeadRecording;
use foveal_eval::gaze::trace_from_head::trace_from_recording;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// A file of a gaze, as it was written.
pub(crate) enum GazeFile {
    /// Directions of eyes, of a head, or of both, at times of their own.
    Trace(Trace),
    /// Eyes in the head and the motion of the head, as published with Hu et al. 2019.
    Recording(HeadRecording),
}

/// Which of them a file counts as where its header says nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GazeForm {
    Trace,
    Recording,
}

impl GazeFile {
    /// Reads a file, one bounded line at a time; by `usual` where its header names neither the time
    /// of a trace nor the motion of a head.
    pub(crate) fn read(path: &Path, usual: GazeForm) -> anyhow::Result<Self> {
        let name = path.display();
        let mut file = BufReader::new(open_file(path, "gaze trace")?);
        let start = file
            .fill_buf()
            .with_context(|| format!("{name}: cannot be read as a gaze trace"))?;
        match form_of(start).unwrap_or(usual) {
            GazeForm::Trace => read_lines(path, file).map(Self::Trace),
            GazeForm::Recording => HeadRecording::read(file)
                .map(Self::Recording)
                .with_context(|| name.to_string()),
        }
    }
}

/// Reads the trace of a file, or the one that a recording of eyes and head is.
pub(crate) fn read_trace(path: &Path) -> anyhow::Result<Trace> {
    match GazeFile::read(path, GazeForm::Trace).map_err(with_hint)? {
        GazeFile::Trace(trace) => Ok(trace),
        GazeFile::Recording(recording) => {
            trace_from_recording(&recording).with_context(|| path.display().to_string())
        }
    }
}

/// Names the way to read a table with another header, as trackers write.
fn with_hint(error: anyhow::Error) -> anyhow::Error {
    let is_other = |cause: &(dyn std::error::Error + 'static)| {
        cause.downcast_ref::<TraceError>() == Some(&TraceError::Header("t_s"))
    };
    match error.chain().any(is_other) {
        true => anyhow!(
            "{}; a tracker's own table is read with --gaze-columns and --gaze-screen, and `foveal \
             gaze record` turns it into a trace",
            told(&error)
        ),
        false => error,
    }
}

/// What the header of a file names.
fn form_of(start: &[u8]) -> Option<GazeForm> {
    let header = start.split(|byte| *byte == b'\n').next()?;
    let header = String::from_utf8_lossy(header);
    let names = header
        .trim_start_matches('\u{feff}')
        .split(',')
        .map(str::trim);
    let names: Vec<&str> = names.collect();
    if names.contains(&"t_s") {
        return Some(GazeForm::Trace);
    }
    let is_motion = names.contains(&"gaze_x") || names.contains(&"head_vel_x");
    is_motion.then_some(GazeForm::Recording)
}

fn read_lines(path: &Path, file: BufReader<File>) -> anyhow::Result<Trace> {
    let mut reader = TraceReader::default();
    each_line(path, file, |line| Ok(reader.line(line)?))?;
    reader.finish().with_context(|| path.display().to_string())
}

/// Reads the table of an eye tracker, whose columns are named.
pub(crate) fn read_table(path: &Path, form: &TrackerForm) -> anyhow::Result<Trace> {
    let file = BufReader::new(open_file(path, "gaze table")?);
    let mut reader = TrackerReader::new(form.clone());
    each_line(path, file, |line| Ok(reader.line(line)?))?;
    reader.finish().with_context(|| path.display().to_string())
}

/// Hands on the lines of a file, each bounded.
fn each_line(
    path: &Path,
    mut file: BufReader<File>,
    mut take: impl FnMut(&[u8]) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let name = path.display();
    let mut line = Vec::new();
    loop {
        line.clear();
        // One byte more than a line may have: the reader then refuses it.
        let read = (&mut file)
            .take(MAX_LINE_BYTES as u64 + 1)
            .read_until(b'\n', &mut line)
            .with_context(|| format!("{name}: cannot be read as a gaze trace"))?;
        if read == 0 {
            return Ok(());
        }
        take(&line).with_context(|| name.to_string())?;
    }
}
