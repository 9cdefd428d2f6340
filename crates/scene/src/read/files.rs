//! Where are the files that a scene names, and what is in them?

use foveal_core::pack::sha256_hex;
use std::collections::HashMap;
use std::io::Read;
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
    folder: PathBuf,
    /// What was read, by path without links: a file is read once, by however many names.
    read: HashMap<PathBuf, Rc<Vec<u8>>>,
    /// Bytes read through it.
    pub(super) bytes: u64,
    /// SHA-256 of each file that was read, in order.
    pub(super) hashes: Vec<String>,
}

impl OnDisk {
    /// The folder that `file` lies in.
    pub(super) fn of(file: &Path) -> Self {
        let folder = match file.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        Self {
            folder: folder.to_owned(),
            read: HashMap::new(),
            bytes: 0,
            hashes: Vec::new(),
        }
    }

    /// All bytes of a scene file.
    pub(super) fn read_scene(&mut self, file: &Path) -> Result<Vec<u8>, ReadError> {
        let bytes = read_regular(file).map_err(|reason| ReadError::Open {
            path: file.to_owned(),
            reason,
        })?;
        self.count(&bytes);
        Ok(bytes)
    }
}

impl OnDisk {
    /// Where the file `name` lies, without links; refused if it lies elsewhere.
    pub(super) fn find(&self, name: &str) -> Result<PathBuf, Fault> {
        let told = |error: std::io::Error| missing(name, error.to_string());
        let path = self.folder.join(inside(name)?);
        let real = path.canonicalize().map_err(told)?;
        let folder = self.folder.canonicalize().map_err(told)?;
        match real.starts_with(folder) {
            true => Ok(real),
            false => Err(leads_out(name)),
        }
    }

    fn count(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        self.hashes.push(sha256_hex(bytes));
    }
}

impl Folder for OnDisk {
    fn read(&mut self, name: &str) -> Result<Rc<Vec<u8>>, Fault> {
        let real = self.find(name)?;
        if let Some(bytes) = self.read.get(&real) {
            return Ok(Rc::clone(bytes));
        }
        let bytes = Rc::new(read_regular(&real).map_err(|reason| missing(name, reason))?);
        self.count(&bytes);
        self.read.insert(real, Rc::clone(&bytes));
        Ok(bytes)
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

/// The bytes of a file; devices, pipes and folders, which may have no end, are refused.
/// What is opened is judged, and opening waits for nobody.
fn read_regular(path: &Path) -> Result<Vec<u8>, String> {
    let mut options = std::fs::OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    let opened = options
        .open(path)
        .and_then(|file| Ok((file.metadata()?, file)));
    let (there, mut file) = opened.map_err(|error| error.to_string())?;
    if !there.is_file() {
        return Err("it is no regular file".to_owned());
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
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
