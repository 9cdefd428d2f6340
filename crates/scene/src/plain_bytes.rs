//! How is a file read that somebody named?

use std::fs::{File, OpenOptions};
use std::io::Read;
use std::path::Path;

/// The bytes of a plain file of at most `most` bytes, or why there are none.
///
/// Folders, devices and pipes, which may have no end, are refused. What is opened is judged, not
/// what lay there before, and opening waits for nobody.
pub(crate) fn plain_bytes(path: &Path, most: u64) -> Result<Vec<u8>, PlainBytesError> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    bytes_of(options.open(path)?, most)
}

/// The same of a file that is open.
pub(crate) fn bytes_of(mut file: File, most: u64) -> Result<Vec<u8>, PlainBytesError> {
    let there = file.metadata()?;
    if !there.is_file() || there.len() > most {
        return Err(PlainBytesError::Other);
    }
    let mut bytes = Vec::new();
    file.by_ref().take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PlainBytesError {
    /// The system refuses.
    #[error("{0}")]
    System(#[from] std::io::Error),
    /// It is no plain file, or larger than it may be.
    #[error("it is no plain file, or too large")]
    Other,
}
