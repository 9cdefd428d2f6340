//! How do results and failures reach whoever called?
//!
//! Results go to stdout: text for people, or with `--json` exactly one JSON object. Everything else
//! goes to stderr.

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

/// Says why the command failed.
pub(crate) fn fail(error: &anyhow::Error) -> ExitCode {
    eprintln!("foveal: {error:#}");
    ExitCode::from(1)
}
