//! What can be wrong with a rig file, and what should its owner do next?

use std::path::{Path, PathBuf};

use foveal_core::units::one_line;
use thiserror::Error;

/// What to do about a rig file that is wrong.
pub(super) const NEXT: &str = "see docs/formats/panels.md";

/// Why a rig file is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}: {place}{what}; {next}", path.display())]
pub struct RigError {
    path: PathBuf,
    place: String,
    what: String,
    next: String,
}

/// A [`RigError`] that does not know its file yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RigFault {
    /// Line and key, or nothing.
    place: String,
    what: String,
    next: String,
}

impl RigFault {
    pub(super) fn new(place: &str, what: impl Into<String>, next: impl Into<String>) -> Self {
        Self {
            place: match place {
                "" => String::new(),
                place => format!("{}: ", one_line(place)),
            },
            what: one_line(&what.into()),
            next: next.into(),
        }
    }

    pub(super) fn in_file(self, path: &Path) -> RigError {
        RigError {
            path: path.to_owned(),
            place: self.place,
            what: self.what,
            next: self.next,
        }
    }
}

#[cfg(test)]
impl std::fmt::Display for RigFault {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}{}; {}", self.place, self.what, self.next)
    }
}

/// What is wrong with the value of a key, such as `panel[2].size`; panels count from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct WrongKey {
    pub(super) key: String,
    pub(super) what: String,
}

impl WrongKey {
    pub(super) fn new(key: impl Into<String>, what: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            what: what.into(),
        }
    }
}
