//! Where are the files that a scene names, and what is in them?

use crate::beneath::{self, Beneath};
use crate::plain_bytes::{PlainBytesError, bytes_of, plain_bytes};
use foveal_core::pack::sha256_hex;
use std::collections::HashMap;
use std::fs::File;
use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

use super::error::{Fault, ReadError};
use super::text::shortened;

/// Where the files lie that a scene file names.
pub(super) trait Folder {
    /// The bytes of the file `name`, the same for all names of one file; refused if it lies
    /// elsewhere.
    fn read(&mut self, name: &str) -> Result<Rc<Vec<u8>>, Fault>;
}

/// The folder of a scene file.
pub(super) struct OnDisk {
    file: PathBuf,
    /// Opened when a file of it is named.
    folder: Option<Beneath>,
    /// What was read: a file is read once, by however many names.
    read: HashMap<FileIdentity, Rc<Vec<u8>>>,
    /// Bytes read through it.
    pub(super) bytes: u64,
    /// SHA-256 of each file that was read, in order.
    pub(super) hashes: Vec<String>,
}

/// A file that a scene file names, and what it names in turn.
pub(super) struct NamedFile {
    /// Where it lies, for messages.
    pub(super) path: PathBuf,
    pub(super) bytes: Vec<u8>,
    pub(super) folder: OnDisk,
}

impl OnDisk {
    /// The folder that `file` lies in.
    pub(super) fn of(file: &Path) -> Self {
        Self {
            file: file.to_owned(),
            folder: None,
            read: HashMap::new(),
            bytes: 0,
            hashes: Vec::new(),
        }
    }

    /// All bytes of the scene file itself.
    pub(super) fn read_scene(&mut self) -> Result<Vec<u8>, ReadError> {
        let bytes = plain_bytes(&self.file, u64::MAX).map_err(|error| ReadError::Open {
            path: self.file.clone(),
            reason: reason(error),
        })?;
        self.count(&bytes);
        Ok(bytes)
    }

    /// A 3D file that it names by this relative path, which [`inside`] made.
    pub(super) fn read_named(&mut self, name: &str) -> Result<NamedFile, Fault> {
        let relative = inside(name)?;
        let file = self.open(name, &relative)?;
        let told = |error| not_opened(name, &error);
        let beneath = self.beneath().map_err(told)?;
        let inner = relative.parent().unwrap_or(Path::new(""));
        let mut folder = Self {
            folder: Some(beneath.inner(inner).map_err(told)?),
            ..Self::of(&beneath.path_of(&relative))
        };
        let bytes = bytes_of(file, u64::MAX).map_err(|error| missing(name, reason(error)))?;
        folder.count(&bytes);
        Ok(NamedFile {
            path: folder.file.clone(),
            bytes,
            folder,
        })
    }

    fn beneath(&mut self) -> std::io::Result<&Beneath> {
        let opened = match self.folder.take() {
            Some(opened) => opened,
            None => Beneath::beside(&self.file)?,
        };
        Ok(self.folder.insert(opened))
    }

    fn open(&mut self, name: &str, relative: &Path) -> Result<File, Fault> {
        let opened = self.beneath().and_then(|it| it.open(relative));
        opened.map_err(|error| not_opened(name, &error))
    }

    fn count(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        self.hashes.push(sha256_hex(bytes));
    }
}

impl Folder for OnDisk {
    fn read(&mut self, name: &str) -> Result<Rc<Vec<u8>>, Fault> {
        let relative = inside(name)?;
        let file = self.open(name, &relative)?;
        let identity = FileIdentity::of(&file, &relative);
        let identity = identity.map_err(|error| not_opened(name, &error))?;
        if let Some(bytes) = self.read.get(&identity) {
            return Ok(Rc::clone(bytes));
        }
        let bytes = bytes_of(file, u64::MAX).map_err(|error| missing(name, reason(error)))?;
        let bytes = Rc::new(bytes);
        self.count(&bytes);
        self.read.insert(identity, Rc::clone(&bytes));
        Ok(bytes)
    }
}

/// What tells a file from others, whatever it is called.
#[derive(PartialEq, Eq, Hash)]
struct FileIdentity {
    /// Device and number, where the system counts files.
    #[cfg(unix)]
    place: (u64, u64),
    #[cfg(not(unix))]
    path: PathBuf,
}

impl FileIdentity {
    #[cfg(unix)]
    fn of(file: &File, _relative: &Path) -> std::io::Result<Self> {
        use std::os::unix::fs::MetadataExt;
        let there = file.metadata()?;
        Ok(Self {
            place: (there.dev(), there.ino()),
        })
    }

    #[cfg(not(unix))]
    fn of(_file: &File, relative: &Path) -> std::io::Result<Self> {
        Ok(Self {
            path: relative.to_owned(),
        })
    }
}

/// A place with no files, for bytes of unknown origin.
pub(super) struct Nowhere;

impl Folder for Nowhere {
    fn read(&mut self, name: &str) -> Result<Rc<Vec<u8>>, Fault> {
        inside(name)?;
        Err(Fault::Missing {
            name: shortened(name),
            reason: "there are no files here".to_owned(),
        })
    }
}

/// Files in memory.
#[cfg(test)]
pub(super) struct Files(pub(super) std::collections::BTreeMap<&'static str, Vec<u8>>);

#[cfg(test)]
impl Folder for Files {
    fn read(&mut self, name: &str) -> Result<Rc<Vec<u8>>, Fault> {
        match self.0.get(name) {
            Some(bytes) => Ok(Rc::new(bytes.clone())),
            None => Nowhere.read(name),
        }
    }
}

/// The relative path that `name` is, with either kind of slash; refused if it leads out.
fn inside(name: &str) -> Result<PathBuf, Fault> {
    let name_with_slashes = name.replace('\\', "/");
    let mut path = PathBuf::new();
    // A colon: `C:`, or a scheme such as `http:`.
    let foreign = name.contains(':') || name.contains('\0');
    for part in Path::new(&name_with_slashes).components() {
        match part {
            Component::Normal(part) => path.push(part),
            Component::CurDir => {}
            Component::ParentDir if path.pop() => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                return Err(leads_out(name));
            }
        }
    }
    if foreign || path.as_os_str().is_empty() {
        return Err(leads_out(name));
    }
    Ok(path)
}

fn missing(name: &str, reason: String) -> Fault {
    Fault::Missing {
        name: shortened(name),
        reason,
    }
}

fn leads_out(name: &str) -> Fault {
    Fault::broken(
        format!("file {:?}", shortened(name)),
        "does not lie in the folder of this file",
        "put it there and name it without the way to it",
    )
}

fn not_opened(name: &str, error: &std::io::Error) -> Fault {
    match beneath::leads_out(error) {
        true => leads_out(name),
        false => missing(name, error.to_string()),
    }
}

fn reason(error: PlainBytesError) -> String {
    match error {
        PlainBytesError::System(error) => error.to_string(),
        PlainBytesError::Other => "it is no regular file".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_out_are_refused() {
        for name in [
            "../a.bin",
            "a/../../b.bin",
            "/etc/passwd",
            "C:\\a.bin",
            "..\\a.bin",
            "http://example.com/a.bin",
            "",
            ".",
            "a\0",
        ] {
            assert!(inside(name).is_err(), "{name:?}");
        }
    }

    #[test]
    fn names_that_stay_inside_are_found() {
        for (name, path) in [
            ("a.bin", "a.bin"),
            ("./b/a.bin", "b/a.bin"),
            ("b\\a.bin", "b/a.bin"),
            ("b/../a.bin", "a.bin"),
        ] {
            assert_eq!(inside(name).ok(), Some(PathBuf::from(path)), "{name:?}");
        }
    }
}
