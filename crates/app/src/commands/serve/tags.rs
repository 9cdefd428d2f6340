//! Which tag identifies a file's content?

use foveal_media::pack::content_tag::content_tag;
use std::collections::HashMap;
use std::fs::{File, Metadata};
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// Most packs whose tags are kept.
const MOST_KEPT: usize = 1024;

/// Tags of packs, by what identifies an open file.
#[derive(Debug, Default)]
pub(super) struct ContentTags {
    known: Mutex<HashMap<FileIdentity, String>>,
}

/// Length, time and place on its device: a file of which all are as they were is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct FileIdentity {
    bytes: u64,
    modified: SystemTime,
    place: [u64; 2],
    changed_ns: [i64; 2],
}

impl FileIdentity {
    fn of(there: &Metadata) -> Self {
        #[cfg(unix)]
        let (place, changed_ns) = {
            use std::os::unix::fs::MetadataExt;
            (
                [there.dev(), there.ino()],
                [there.ctime(), there.ctime_nsec()],
            )
        };
        #[cfg(not(unix))]
        let (place, changed_ns) = ([0; 2], [0; 2]);
        Self {
            bytes: there.len(),
            modified: modified(there),
            place,
            changed_ns,
        }
    }
}

impl ContentTags {
    /// The tag of the content of an open file; `None` of what is no whole pack.
    pub(super) fn of(&self, file: &mut File, there: &Metadata) -> Option<String> {
        let identity = FileIdentity::of(there);
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(tag) = known().get(&identity) {
            return Some(tag.clone());
        }
        let content = content_tag(file).ok().flatten()?;
        let tag = format!("\"{content}\"");
        let mut known = known();
        if known.len() >= MOST_KEPT {
            known.clear();
        }
        known.insert(identity, tag.clone());
        Some(tag)
    }
}

/// When a file was last changed, as far as the system says.
pub(super) fn modified(there: &Metadata) -> SystemTime {
    there.modified().unwrap_or(UNIX_EPOCH)
}

/// A tag of a length and a time.
pub(super) fn tag_of(length: u64, modified: SystemTime) -> String {
    let since = modified.duration_since(UNIX_EPOCH).unwrap_or_default();
    format!("\"{length:x}-{:x}\"", since.as_nanos())
}
