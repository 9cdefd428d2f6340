//! How do results and failures reach whoever called?
//!
//! Results go to stdout: text for people, or with `--json` exactly one JSON object. Everything else
//! goes to stderr.

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// Prints `result` as one JSON object, or `text` for people.
pub(crate) fn result(json: bool, result: &impl Serialize, text: &str) -> anyhow::Result<()> {
    let line = if json {
        serde_json::to_string(result)?
    } else {
        text.trim_end().to_owned()
    };
    match writeln!(std::io::stdout(), "{line}") {
        // Whoever reads has seen enough (`foveal info | head`).
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => Ok(done?),
    }
}

/// A command line that parses but cannot be meant.
#[derive(Debug)]
pub(crate) struct WrongUsage(pub(crate) String);

impl std::fmt::Display for WrongUsage {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for WrongUsage {}

/// The error for an option with this name and value out of `range`.
pub(crate) fn out_of_range(option: &str, found: impl ToString, range: &str) -> WrongUsage {
    WrongUsage(format!("{option} is {}; give {range}", found.to_string()))
}

/// Says why the command failed: 2 for wrong usage, 1 for anything else.
pub(crate) fn fail(error: &anyhow::Error) -> ExitCode {
    eprintln!("foveal: {error:#}");
    ExitCode::from(if error.is::<WrongUsage>() { 2 } else { 1 })
}

/// What a progress bar counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Counting {
    Frames,
    Bytes,
}

/// A progress bar with rate and time left on a terminal; silent in a pipe. Without a length it
/// counts up.
pub(crate) fn bar(length: Option<u64>, counting: Counting) -> ProgressBar {
    let bar = match length {
        Some(length) => ProgressBar::new(length),
        None => ProgressBar::no_length(),
    };
    let template = match (counting, length) {
        (Counting::Frames, Some(_)) => "{wide_bar} {pos}/{len} frames, {per_sec}, {eta} left",
        (Counting::Frames, None) => "{spinner} {pos} frames, {per_sec}",
        (Counting::Bytes, _) => "{wide_bar} {bytes}/{total_bytes}, {bytes_per_sec}, {eta} left",
    };
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
