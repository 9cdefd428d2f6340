//! Who may write the pack of a name, and what becomes of what has it already?

use crate::pack::pack_file::{PackFileError, partial_path};
use crate::plain_file::{rename_durably, rename_new};
use foveal_core::pack::MAGIC;
use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What becomes of a pack that has the name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IfTaken {
    /// It stays: who would write another is refused, also if it comes while the other is made.
    Refuse,
    /// It stays until the other is whole.
    Replace,
}

/// The right to write the pack of a name. It is exclusive while it is held: the file in
/// which the pack grows lies next to the name, and is locked.
///
/// ```no_run
/// use foveal_media::pack::name_claim::{IfTaken, NameClaim};
/// let out = std::path::Path::new("scene.foveal");
/// let claim = NameClaim::of(out, IfTaken::Refuse)?;
/// assert!(NameClaim::of(out, IfTaken::Replace).is_err());
/// # drop(claim);
/// # Ok::<(), foveal_media::pack::pack_file::PackFileError>(())
/// ```
#[derive(Debug)]
pub struct NameClaim {
    path: PathBuf,
    partial: PathBuf,
    if_taken: IfTaken,
    /// When what lay under the name at the beginning was last changed.
    replaced: Option<SystemTime>,
    /// None once it was handed out.
    file: Option<File>,
    is_rest: bool,
}

impl NameClaim {
    /// Claims a name.
    ///
    /// # Errors
    /// It cannot be written there, something else than a pack has the name, or the name of the file
    /// that grows; another preparation writes it; a pack has it and is to stay.
    pub fn of(path: &Path, if_taken: IfTaken) -> Result<Self, PackFileError> {
        let partial = partial_path(path);
        let claimed = refuse_anything_but_a_file(path).and_then(|()| lock(&partial));
        let (file, is_rest) = claimed.map_err(|source| cannot_begin(path, source))?;
        let claim = Self {
            path: path.to_owned(),
            partial,
            if_taken,
            replaced: last_change(path),
            file: Some(file),
            is_rest,
        };
        if if_taken == IfTaken::Refuse && is_taken(path) {
            return Err(cannot_begin(path, taken()));
        }
        Ok(claim)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Where the pack grows.
    pub(super) fn partial(&self) -> &Path {
        &self.partial
    }

    /// What an earlier preparation of this name left, if it left anything.
    pub(super) fn take_rest(&mut self) -> Option<File> {
        match self.is_rest {
            true => self.file.take(),
            false => None,
        }
    }

    /// The file in which the pack grows, empty. What an earlier preparation left goes: another name
    /// of that file keeps its bytes.
    pub(super) fn take_empty(&mut self) -> Result<File, Error> {
        // A rest stays locked until the new file is there.
        let begun = self.file.take();
        if !self.is_rest
            && let Some(file) = begun
        {
            return Ok(file);
        }
        std::fs::remove_file(&self.partial)?;
        self.is_rest = false;
        create_locked(&self.partial)
    }

    /// Gives the grown file its name.
    pub(super) fn give_name(&self) -> Result<(), Error> {
        if last_change(&self.path) != self.replaced {
            return Err(taken());
        }
        if self.if_taken == IfTaken::Replace {
            return rename_durably(&self.partial, &self.path);
        }
        match rename_new(&self.partial, &self.path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => match is_taken(&self.path) {
                true => Err(taken()),
                false => rename_durably(&self.partial, &self.path),
            },
            done => done,
        }
    }
}

impl Drop for NameClaim {
    fn drop(&mut self) {
        // What was handed out is its writer's, and a rest may be gone on with.
        if self.file.is_some() && !self.is_rest {
            let _ = std::fs::remove_file(&self.partial);
        }
    }
}

fn taken() -> Error {
    Error::new(
        ErrorKind::AlreadyExists,
        "another pack has taken its name meanwhile",
    )
}

/// Whether anything but an empty file has the name.
fn is_taken(path: &Path) -> bool {
    let there = std::fs::symlink_metadata(path);
    there.is_ok_and(|there| !there.is_file() || there.len() > 0)
}

fn last_change(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path)
        .and_then(|there| there.modified())
        .ok()
}

pub(super) fn cannot_begin(path: &Path, source: Error) -> PackFileError {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let next = match folder.filter(|folder| !folder.exists()) {
        Some(folder) => format!("make the folder {} first", folder.display()),
        None => "choose another --out".to_owned(),
    };
    PackFileError::Io {
        path: path.to_owned(),
        what: format!("cannot be written; {next}"),
        source,
    }
}

/// A rename would put the pack in the place of a device such as /dev/null, or of a link.
fn refuse_anything_but_a_file(path: &Path) -> Result<(), Error> {
    match std::fs::symlink_metadata(path) {
        Ok(there) if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(there) if there.is_symlink() => Err(Error::other("it is a link; name its target")),
        Ok(there) if !there.is_file() => Err(Error::other("it is not a plain file")),
        _ => Ok(()),
    }
}

/// Opens and locks the file that grows, and returns whether an earlier preparation left it.
fn lock(partial: &Path) -> Result<(File, bool), Error> {
    match open_rest(partial)? {
        Some(file) => Ok((file, true)),
        None => Ok((create_locked(partial)?, false)),
    }
}

/// Creates the file that grows, and locks it for as long as it is open.
fn create_locked(partial: &Path) -> Result<File, Error> {
    let mut options = File::options();
    let created = options
        .read(true)
        .write(true)
        .create_new(true)
        .open(partial);
    let file = created.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => in_the_way(partial, BUSY),
        _ => error,
    })?;
    file.try_lock().map_err(|_| in_the_way(partial, BUSY))?;
    Ok(file)
}

const BUSY: &str = "another prepare is writing it";

fn in_the_way(partial: &Path, why: &str) -> Error {
    Error::other(format!("{} is in the way: {why}", partial.display()))
}

/// Opens and locks the rest of a `prepare` that was stopped; `None` where nothing lies.
///
/// Refuses a link, another user's file, and one that another `prepare` is writing.
fn open_rest(partial: &Path) -> Result<Option<File>, Error> {
    let Ok(there) = std::fs::symlink_metadata(partial) else {
        return Ok(None);
    };
    if !there.is_file() {
        return Err(in_the_way(partial, "it is not a plain file"));
    }
    let mut file = File::options().read(true).write(true).open(partial)?;
    if file.try_lock().is_err() {
        return Err(in_the_way(partial, BUSY));
    }
    // Another prepare may have given it its name between the opening and the lock.
    let now = std::fs::symlink_metadata(partial);
    if !now.is_ok_and(|now| file.metadata().is_ok_and(|it| is_same(&it, &now))) {
        return Err(in_the_way(partial, BUSY));
    }
    let mut begins = Vec::new();
    (&mut file)
        .take(MAGIC.len() as u64)
        .read_to_end(&mut begins)?;
    if begins != MAGIC && begins.iter().any(|byte| *byte != 0) {
        return Err(in_the_way(
            partial,
            "it is no half-written pack; move it away",
        ));
    }
    Ok(Some(file))
}

#[cfg(unix)]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    one.dev() == other.dev() && one.ino() == other.ino()
}

#[cfg(not(unix))]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    one.len() == other.len() && one.modified().ok() == other.modified().ok()
}
