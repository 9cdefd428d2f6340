//! Where is written down what was selected?

use crate::report::output::growing_name;
use anyhow::Context;
use foveal_media::plain_file::open_sink;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file of `--log`.
pub(crate) struct LogFile {
    path: PathBuf,
    out: File,
}

impl LogFile {
    /// Makes the file.
    pub(crate) fn create(path: &Path) -> anyhow::Result<Self> {
        let out = match growing_name(path) {
            Some(_) => File::create(path),
            None => open_sink(path),
        };
        let out = out.with_context(|| format!("--log {}: cannot be written", path.display()))?;
        Ok(Self {
            path: path.to_owned(),
            out,
        })
    }

    /// Writes whole lines at once: what was written when the program is killed can be replayed.
    pub(crate) fn write(&mut self, text: &str) -> anyhow::Result<()> {
        let written = self.out.write_all(text.as_bytes());
        written.with_context(|| format!("--log {}: cannot be written", self.path.display()))
    }
}
