//! How is a file opened that lies in a folder, and none that lies elsewhere?
//!
//! The author of a scene or rig file names the files next to it, and may be a stranger. Links are
//! followed as long as they stay in the folder. Nothing is looked at before it is opened: between
//! the two, another thing could take its name.

use std::fs::File;
use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};

/// Most names of a folder that are looked at.
const MOST_NAMES: usize = 1 << 16;

/// A folder and what lies beneath it.
#[derive(Debug)]
pub struct Beneath {
    folder: PathBuf,
    /// The folder itself, whatever takes its name.
    #[cfg(target_os = "linux")]
    handle: rustix::fd::OwnedFd,
}

impl Beneath {
    /// The folder that a file lies in.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn beside(file: &Path) -> Result<Self> {
        let folder = match file.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        Self::of(folder)
    }

    /// A folder.
    ///
    /// # Errors
    /// It cannot be opened.
    #[cfg(target_os = "linux")]
    pub fn of(folder: &Path) -> Result<Self> {
        use rustix::fs::{Mode, OFlags, open};
        let flags = OFlags::PATH | OFlags::DIRECTORY | OFlags::CLOEXEC;
        Ok(Self {
            handle: open(folder, flags, Mode::empty())?,
            folder: folder.to_owned(),
        })
    }

    /// A folder.
    ///
    /// # Errors
    /// None: what cannot be opened shows when a file of it is.
    #[cfg(not(target_os = "linux"))]
    pub fn of(folder: &Path) -> Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    /// A folder that lies there, by a relative name; itself by an empty one.
    ///
    /// # Errors
    /// As [`Self::open`] has them.
    pub fn inner(&self, name: &Path) -> Result<Self> {
        if name.as_os_str().is_empty() {
            return self.again();
        }
        let there = self.open(name)?;
        if !there.metadata()?.is_dir() {
            return Err(ErrorKind::NotADirectory.into());
        }
        Ok(Self {
            folder: self.folder.join(name),
            #[cfg(target_os = "linux")]
            handle: there.into(),
        })
    }

    fn again(&self) -> Result<Self> {
        Ok(Self {
            folder: self.folder.clone(),
            #[cfg(target_os = "linux")]
            handle: self.handle.try_clone()?,
        })
    }

    /// The name of what lies there under a relative name that differs in capitals alone, if there
    /// is something.
    #[must_use]
    pub fn in_other_capitals(&self, name: &Path) -> Option<PathBuf> {
        let mut found = PathBuf::new();
        for part in name.components() {
            let Component::Normal(part) = part else {
                return None;
            };
            let wanted = part.to_str()?.to_lowercase();
            let inner = self.inner(&found).ok()?;
            // What is listed may be another folder by then; what is opened is not.
            let listed = std::fs::read_dir(inner.path_of(Path::new(""))).ok()?;
            let names = listed.take(MOST_NAMES).flatten().map(|it| it.file_name());
            let is_alike = |it: &String| it.to_lowercase() == wanted;
            let alike = names
                .filter_map(|it| it.into_string().ok())
                .filter(is_alike);
            found.push(alike.min()?);
        }
        (found != *name).then_some(found)
    }

    /// Where something lies, for messages.
    #[must_use]
    pub fn path_of(&self, name: &Path) -> PathBuf {
        self.folder.join(name)
    }

    /// Opens what lies there under a relative name, for reading. Opening does not wait; what was
    /// opened may be a folder, a pipe or a device.
    ///
    /// # Errors
    /// It cannot be opened, or lies elsewhere: [`leads_out`] says which.
    pub fn open(&self, name: &Path) -> Result<File> {
        let mut parts = name.components();
        if !parts.all(|part| matches!(part, Component::Normal(_))) {
            return Err(out());
        }
        self.open_inside(name)
    }

    #[cfg(target_os = "linux")]
    fn open_inside(&self, name: &Path) -> Result<File> {
        use rustix::fs::{Mode, OFlags, ResolveFlags, openat2};
        use rustix::io::Errno;
        let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
        let inside = ResolveFlags::BENEATH | ResolveFlags::NO_MAGICLINKS;
        // A rename meanwhile makes the system give up, which is not the file's fault.
        for _ in 0..MOST_TRIES {
            match openat2(&self.handle, name, flags, Mode::empty(), inside) {
                Ok(file) => return Ok(file.into()),
                Err(Errno::AGAIN) => {}
                // Links that name the whole way count as leading out; they may lead back.
                Err(Errno::XDEV) => return self.open_and_compare(name),
                // Linux before 5.6, and what filters system calls.
                Err(Errno::NOSYS | Errno::PERM) => return self.open_and_compare(name),
                Err(other) => return Err(other.into()),
            }
        }
        self.open_and_compare(name)
    }

    #[cfg(not(target_os = "linux"))]
    fn open_inside(&self, name: &Path) -> Result<File> {
        self.open_and_compare(name)
    }

    /// Opens a file, then looks whether it is one that lies in the folder.
    fn open_and_compare(&self, name: &Path) -> Result<File> {
        let path = self.folder.join(name);
        let mut options = std::fs::OpenOptions::new();
        options.read(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::custom_flags(
            &mut options,
            libc::O_NONBLOCK | libc::O_NOCTTY,
        );
        let file = options.open(&path)?;
        let real = path.canonicalize()?;
        if !real.starts_with(self.folder.canonicalize()?) {
            return Err(out());
        }
        // What has the path now that leads there without links is what was opened.
        match is_same(&file, &real)? {
            true => Ok(file),
            false => Err(out()),
        }
    }
}

/// How often a name is tried that is moved about.
#[cfg(target_os = "linux")]
const MOST_TRIES: usize = 8;

/// Whether a file that is open is what lies at a path which is no link.
#[cfg(unix)]
fn is_same(file: &File, path: &Path) -> Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let place = |it: &std::fs::Metadata| (it.dev(), it.ino());
    let there = std::fs::symlink_metadata(path)?;
    Ok(place(&file.metadata()?) == place(&there))
}

#[cfg(not(unix))]
fn is_same(_file: &File, path: &Path) -> Result<bool> {
    Ok(!std::fs::symlink_metadata(path)?.is_symlink())
}

fn out() -> Error {
    Error::new(ErrorKind::InvalidInput, LeadsOut)
}

/// A name that leads out of its folder.
#[derive(Debug, thiserror::Error)]
#[error("leads out of the folder")]
struct LeadsOut;

/// Whether a file was not opened since it lies elsewhere.
#[must_use]
pub fn leads_out(error: &Error) -> bool {
    error.get_ref().is_some_and(|it| it.is::<LeadsOut>())
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let name = format!("foveal-beneath-{}-{name}", std::process::id());
            let path = std::env::temp_dir().join(name);
            std::fs::create_dir_all(path.join("in/sub")).unwrap();
            std::fs::write(path.join("secret"), b"secret").unwrap();
            std::fs::write(path.join("in/file"), b"file").unwrap();
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    /// What either way of opening gives.
    fn both(folder: &Folder, name: &str) -> [Result<String>; 2] {
        let inside = Beneath::beside(&folder.0.join("in/scene.toml")).unwrap();
        let name = Path::new(name);
        let read = |file: File| std::io::read_to_string(file);
        [
            inside.open(name).and_then(read),
            inside.open_and_compare(name).and_then(read),
        ]
    }

    #[test]
    fn what_lies_in_the_folder_is_opened_through_whatever_links_stay_there() {
        let folder = Folder::new("stays");
        symlink("../file", folder.0.join("in/sub/back")).unwrap();
        symlink(folder.0.join("in/file"), folder.0.join("in/whole")).unwrap();
        symlink("sub", folder.0.join("in/other")).unwrap();
        for name in ["file", "sub/back", "whole", "other/back"] {
            for found in both(&folder, name) {
                assert_eq!(found.unwrap(), "file", "{name}");
            }
        }
    }

    #[test]
    fn nothing_is_opened_that_links_lead_out_to() {
        let folder = Folder::new("leads");
        symlink("../secret", folder.0.join("in/near")).unwrap();
        symlink(folder.0.join("secret"), folder.0.join("in/far")).unwrap();
        symlink("..", folder.0.join("in/up")).unwrap();
        symlink("/proc/self/fd/0", folder.0.join("in/magic")).unwrap();
        for name in ["near", "far", "up/secret", "magic"] {
            for found in both(&folder, name) {
                let error = found.unwrap_err();
                assert!(leads_out(&error) || name == "magic", "{name}: {error}");
            }
        }
        let inside = Beneath::beside(&folder.0.join("in/scene.toml")).unwrap();
        for name in ["../secret", "/etc/passwd", "sub/../../secret"] {
            assert!(
                leads_out(&inside.open(Path::new(name)).unwrap_err()),
                "{name}"
            );
        }
    }

    #[test]
    fn a_name_that_is_a_file_and_a_link_in_turn_never_leads_out() {
        let folder = Folder::new("turns");
        let path = folder.0.join("in/turning");
        let turning = std::sync::atomic::AtomicBool::new(true);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let [file, link] = ["a", "b"].map(|name| folder.0.join(name));
                while turning.load(std::sync::atomic::Ordering::Relaxed) {
                    std::fs::write(&file, b"file").unwrap();
                    std::fs::rename(&file, &path).unwrap();
                    let _ = std::fs::remove_file(&link);
                    symlink("../secret", &link).unwrap();
                    std::fs::rename(&link, &path).unwrap();
                }
            });
            for _ in 0..2000 {
                for found in both(&folder, "turning").into_iter().flatten() {
                    assert_eq!(found, "file");
                }
            }
            turning.store(false, std::sync::atomic::Ordering::Relaxed);
        });
    }
}
