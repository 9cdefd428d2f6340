//! Where are the files that a scene names, and what is in them?

use crate::beneath::{self, Beneath};
use crate::plain_bytes::{PlainBytesError, bytes_of, most_kept, plain_bytes};
use foveal_core::pack::sha256_hex;
use std::collections::HashMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::error::{Fault, ReadError, said};
use super::search::{Folder, Names, NotOpened, Taken, inside, key};
use super::sound::count;
use super::text::shortened;
use crate::source::Repairs;

/// Most names of a folder that are looked at.
const MOST_NAMES: usize = 1 << 16;

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
    /// Whether files outside of it are opened.
    allow_outside: bool,
    /// The names in folders of it that were looked at.
    names: HashMap<PathBuf, Rc<Names>>,
    /// What was used in place of files of other names.
    pub(super) remarks: Vec<String>,
    pub(super) repairs: Repairs,
}

/// A file that a scene file names, and what it names in turn.
pub(super) struct NamedFile {
    /// Where it lies, for messages.
    pub(super) path: PathBuf,
    pub(super) bytes: Vec<u8>,
    pub(super) folder: OnDisk,
}

impl OnDisk {
    /// The folder that `file` lies in; may files elsewhere be opened that it names?
    pub(super) fn of(file: &Path, allow_outside: bool) -> Self {
        Self {
            allow_outside,
            names: HashMap::new(),
            remarks: Vec::new(),
            repairs: Repairs::new(),
            file: file.to_owned(),
            folder: None,
            read: HashMap::new(),
            bytes: 0,
            hashes: Vec::new(),
        }
    }

    /// All bytes of the scene file itself.
    pub(super) fn read_scene(&mut self) -> Result<Vec<u8>, ReadError> {
        let bytes = plain_bytes(&self.file, most_kept()).map_err(|error| ReadError::Open {
            path: self.file.clone(),
            reason: reason(error),
        })?;
        self.count(&bytes);
        Ok(bytes)
    }

    /// A 3D file that it names.
    pub(super) fn read_named(&mut self, name: &str) -> Result<NamedFile, Fault> {
        let relative = match inside(name) {
            Some(relative) => relative,
            None if self.allow_outside => return self.read_outside(name),
            None => return Err(leads_out(name)),
        };
        let file = self.open(name, &relative)?;
        let told = |error| not_opened(name, &error);
        let beneath = self.beneath().map_err(told)?;
        let inner = relative.parent().unwrap_or(Path::new(""));
        let mut folder = Self {
            folder: Some(beneath.inner(inner).map_err(told)?),
            ..Self::of(&beneath.path_of(&relative), self.allow_outside)
        };
        let bytes = bytes_of(file, most_kept()).map_err(|error| missing(name, reason(error)))?;
        folder.count(&bytes);
        Ok(NamedFile {
            path: folder.file.clone(),
            bytes,
            folder,
        })
    }

    /// A 3D file that lies elsewhere.
    fn read_outside(&self, name: &str) -> Result<NamedFile, Fault> {
        let path = self.path_of(Path::new(name));
        let mut folder = Self::of(&path, true);
        let bytes =
            plain_bytes(&path, most_kept()).map_err(|error| missing(name, reason(error)))?;
        folder.count(&bytes);
        Ok(NamedFile {
            path,
            bytes,
            folder,
        })
    }

    /// Where a name leads to from here.
    fn path_of(&self, name: &Path) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(name)
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
    fn open(&mut self, relative: &Path) -> Result<Rc<Vec<u8>>, NotOpened> {
        let opened = self.beneath().and_then(|it| it.open(relative));
        let file = opened.map_err(|error| not_found(&error))?;
        let identity = FileIdentity::of(&file, relative).map_err(|error| not_found(&error))?;
        if let Some(bytes) = self.read.get(&identity) {
            return Ok(Rc::clone(bytes));
        }
        let bytes = bytes_of(file, most_kept());
        let bytes = Rc::new(bytes.map_err(|error| NotOpened::Because(reason(error)))?);
        self.count(&bytes);
        self.read.insert(identity, Rc::clone(&bytes));
        Ok(bytes)
    }

    fn open_outside(&mut self, name: &Path) -> Option<Rc<Vec<u8>>> {
        if !self.allow_outside {
            return None;
        }
        let slashes = name.to_string_lossy().replace('\\', "/");
        let paths = [self.path_of(name), self.path_of(Path::new(&slashes))];
        let mut there = paths
            .iter()
            .filter_map(|it| plain_bytes(it, most_kept()).ok());
        let bytes = Rc::new(there.next()?);
        self.count(&bytes);
        Some(bytes)
    }

    fn names(&mut self, relative: &Path) -> Rc<Names> {
        if let Some(known) = self.names.get(relative) {
            return Rc::clone(known);
        }
        // What is listed may be another folder by then; what is opened is not.
        let listed = self.beneath().and_then(|it| {
            let inner = it.inner(relative)?;
            std::fs::read_dir(inner.path_of(Path::new("")))
        });
        let entries = listed.into_iter().flatten().take(MOST_NAMES).flatten();
        let names = entries.filter_map(|it| it.file_name().into_string().ok());
        let names = Rc::new(names_of(names.collect()));
        self.names.insert(relative.to_owned(), Rc::clone(&names));
        names
    }

    fn tell(&mut self, taken: Taken) {
        let before = self.repairs.values().sum();
        count(&mut self.repairs, taken.repair(), 1);
        if Taken::is_told(before) {
            self.remarks.push(taken.remark);
        }
    }
}

/// Names by themselves and by what makes them alike.
fn names_of(mut all: Vec<String>) -> Names {
    all.sort();
    let mut names = Names::with_capacity(2 * all.len());
    for name in &all {
        names.insert(name.clone(), name.clone());
    }
    for name in all {
        names.entry(key(&name)).or_insert(name);
    }
    names
}

/// What identifies a file, whatever it is called.
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
    fn open(&mut self, _relative: &Path) -> Result<Rc<Vec<u8>>, NotOpened> {
        Err(NotOpened::Because("there are no files here".to_owned()))
    }

    fn names(&mut self, _relative: &Path) -> Rc<Names> {
        Rc::default()
    }

    fn tell(&mut self, _taken: Taken) {}
}

/// Files in memory.
#[cfg(test)]
pub(super) struct Files(pub(super) std::collections::BTreeMap<&'static str, Vec<u8>>);

#[cfg(test)]
impl Folder for Files {
    fn open(&mut self, relative: &Path) -> Result<Rc<Vec<u8>>, NotOpened> {
        let bytes = relative.to_str().and_then(|name| self.0.get(name));
        match bytes {
            Some(bytes) => Ok(Rc::new(bytes.clone())),
            None => Nowhere.open(relative),
        }
    }

    fn names(&mut self, relative: &Path) -> Rc<Names> {
        let within = self.0.keys().filter_map(|it| {
            let rest = Path::new(it).strip_prefix(relative).ok()?;
            Some(rest.iter().next()?.to_str()?.to_owned())
        });
        Rc::new(names_of(within.collect()))
    }

    fn tell(&mut self, _taken: Taken) {}
}

fn missing(name: &str, reason: String) -> Fault {
    Fault::Missing {
        name: shortened(name),
        reason,
    }
}

fn leads_out(name: &str) -> Fault {
    Fault::broken(
        format!("file \"{}\"", shortened(name)),
        "does not lie in the folder of this file",
        "put it there and name it without the way to it",
    )
}

fn not_opened(name: &str, error: &std::io::Error) -> Fault {
    match beneath::leads_out(error) {
        true => leads_out(name),
        false => missing(name, said(error)),
    }
}

fn not_found(error: &std::io::Error) -> NotOpened {
    match beneath::leads_out(error) {
        true => NotOpened::Outside,
        false => NotOpened::Because(said(error)),
    }
}

fn reason(error: PlainBytesError) -> String {
    match error {
        PlainBytesError::System(error) => said(&error),
        PlainBytesError::Other => "it is no regular file".to_owned(),
        PlainBytesError::Large(there, most) => {
            format!("it has {there} bytes, more than the {most} of this machine's memory: split it")
        }
    }
}
