//! What trace does a file hold?

use crate::report::output::open_file;
use anyhow::Context;
use foveal_core::gaze::read::trace::{MAX_LINE_BYTES, Trace, TraceReader};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Reads a trace, one bounded line at a time.
pub(crate) fn read_trace(path: &Path) -> anyhow::Result<Trace> {
    let name = path.display();
    let file = open_file(path, "gaze trace")?;
    let mut file = BufReader::new(file);
    let mut reader = TraceReader::default();
    let mut line = Vec::new();
    loop {
        line.clear();
        // One byte more than a line may have: the reader then refuses it.
        let read = (&mut file)
            .take(MAX_LINE_BYTES as u64 + 1)
            .read_until(b'\n', &mut line)
            .with_context(|| format!("{name}: cannot be read as a gaze trace"))?;
        if read == 0 {
            return reader.finish().with_context(|| name.to_string());
        }
        reader.line(&line).with_context(|| name.to_string())?;
    }
}
