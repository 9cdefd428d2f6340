//! How is a named file read?

use std::fs::{File, OpenOptions};
use std::io::Read;
use std::path::Path;

/// The bytes of a plain file of at most `most` bytes, or why there are none.
///
/// Folders, devices and pipes, which may have no end, are refused. What is opened is judged, not
/// what lay there before, and opening does not wait.
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
    if !there.is_file() {
        return Err(PlainBytesError::Other);
    }
    if there.len() > most {
        return Err(PlainBytesError::Large(there.len(), most));
    }
    let mut bytes = Vec::new();
    file.by_ref().take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Most bytes of a file that is kept whole: as many as the machine has memory, where Linux says,
/// else 64 GiB.
pub(crate) fn most_kept() -> u64 {
    let told = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let total = told.lines().find_map(|line| line.strip_prefix("MemTotal:"));
    let kib = total.and_then(|rest| rest.split_whitespace().next()?.parse().ok());
    kib.map_or(1 << 36, |kib: u64| kib.saturating_mul(1024))
}

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PlainBytesError {
    /// The system refuses.
    #[error("{0}")]
    System(#[from] std::io::Error),
    /// It is larger than it may be, both in bytes.
    #[error("it has {0} bytes, and at most {1} can be read")]
    Large(u64, u64),
    /// It is not a plain file.
    #[error("it is not a plain file")]
    Other,
}
