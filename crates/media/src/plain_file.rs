//! How is a named file read, whatever is or comes there, and how is it given its name?
//!
//! All that the program reads of a name that it was given is opened here, or by scene's reader of
//! meshes: `cargo xtask tidy` refuses other openings.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};
use std::path::Path;

/// Opens a file for reading. What is opened is judged, not what lay there before, and opening does
/// not wait, as opening a pipe would.
///
/// # Errors
/// It cannot be opened, is a folder, or not a plain file.
pub fn open_plain(path: &Path) -> Result<(File, Metadata)> {
    judged(path, 0)
}

/// The same, refusing a link in the path's last name.
///
/// # Errors
/// As there.
pub fn open_unlinked(path: &Path) -> Result<(File, Metadata)> {
    #[cfg(unix)]
    let flags = libc::O_NOFOLLOW;
    #[cfg(not(unix))]
    let flags = 0;
    judged(path, flags)
}

/// The bytes of a plain file of at most `most` bytes, however it grows meanwhile.
///
/// # Errors
/// As there, or [`ErrorKind::FileTooLarge`].
pub fn read_plain(path: &Path, most: u64) -> Result<Vec<u8>> {
    let (file, there) = open_plain(path)?;
    let mut bytes = Vec::new();
    if there.len() <= most {
        file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    }
    match there.len() <= most && bytes.len() as u64 <= most {
        true => Ok(bytes),
        false => Err(ErrorKind::FileTooLarge.into()),
    }
}

/// The first bytes of a plain file, at most `most` of them.
///
/// # Errors
/// It cannot be opened or read, is a folder, or not a plain file.
pub fn first_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut first = Vec::new();
    open_plain(path)?.0.take(most).read_to_end(&mut first)?;
    Ok(first)
}

/// The last bytes of a plain file, at most `most` of them.
///
/// # Errors
/// As there.
pub fn last_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let (mut file, there) = open_plain(path)?;
    file.seek(SeekFrom::Start(there.len().saturating_sub(most)))?;
    let mut last = Vec::new();
    file.take(most).read_to_end(&mut last)?;
    Ok(last)
}

/// Opens a device or a pipe for writing, which takes bytes as they come. A pipe without a
/// reader would be waited for, and is refused.
///
/// # Errors
/// It cannot be opened, or has no reader.
pub fn open_sink(path: &Path) -> Result<File> {
    let mut options = OpenOptions::new();
    options.write(true);
    // As long as this is open there is a writer, and opening waits for none.
    #[cfg(unix)]
    let _at_once =
        std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options.clone(), libc::O_NONBLOCK)
            .open(path)
            .map_err(|error| match error.raw_os_error() {
                Some(libc::ENXIO) => {
                    Error::other("this pipe has no reader; start its reader first")
                }
                _ => error,
            })?;
    options.open(path)
}

/// Opens a folder, so that it can be locked.
///
/// # Errors
/// It cannot be opened, as on systems that open no folders.
pub fn open_folder(path: &Path) -> Result<File> {
    File::open(path)
}

/// Gives a file another name once its bytes are on disk, in the place of what had that, and makes
/// the name durable, which is in its folder.
///
/// # Errors
/// It cannot be renamed, or its folder not be written.
pub fn rename_durably(from: &Path, to: &Path) -> Result<()> {
    durably(from, to, |from, to| std::fs::rename(from, to))
}

/// The same, unless something has the name already.
///
/// # Errors
/// As there, or [`ErrorKind::AlreadyExists`].
pub fn rename_new(from: &Path, to: &Path) -> Result<()> {
    durably(from, to, rename_if_free)
}

fn durably(from: &Path, to: &Path, rename: impl FnOnce(&Path, &Path) -> Result<()>) -> Result<()> {
    File::open(from)?.sync_all()?;
    let folder = to.parent().filter(|it| !it.as_os_str().is_empty());
    // Before the name is given: a failure leaves nothing under it. A folder that can be written
    // and not read, or any elsewhere than on Unix, is left to the system.
    let folder = File::open(folder.unwrap_or(Path::new("."))).ok();
    rename(from, to)?;
    match folder.map_or(Ok(()), |it| it.sync_all()) {
        // Some file systems have no such call for folders.
        Err(error)
            if !matches!(
                error.kind(),
                ErrorKind::InvalidInput | ErrorKind::Unsupported
            ) =>
        {
            Err(error)
        }
        _ => Ok(()),
    }
}

/// Renames in one step, in which nothing can take the name, where the file system has that.
fn rename_if_free(from: &Path, to: &Path) -> Result<()> {
    match rename_at_once(from, to) {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::InvalidInput | ErrorKind::Unsupported
            ) => {}
        done => return done,
    }
    match std::fs::symlink_metadata(to) {
        Ok(_) => Err(ErrorKind::AlreadyExists.into()),
        Err(_) => std::fs::rename(from, to),
    }
}

#[cfg(target_os = "linux")]
#[allow(unsafe_code)] // The standard library has no rename that replaces nothing.
fn rename_at_once(from: &Path, to: &Path) -> Result<()> {
    use std::os::unix::ffi::OsStrExt;
    let name = |path: &Path| std::ffi::CString::new(path.as_os_str().as_bytes());
    let (from, to) = (name(from)?, name(to)?);
    let here = libc::AT_FDCWD;
    // SAFETY: both names end in NUL and outlive the call, which writes to neither.
    let done = unsafe {
        libc::syscall(
            libc::SYS_renameat2,
            here,
            from.as_ptr(),
            here,
            to.as_ptr(),
            libc::RENAME_NOREPLACE,
        )
    };
    match done {
        0 => Ok(()),
        _ => Err(Error::last_os_error()),
    }
}

#[cfg(not(target_os = "linux"))]
fn rename_at_once(_: &Path, _: &Path) -> Result<()> {
    Err(ErrorKind::Unsupported.into())
}

fn judged(path: &Path, flags: i32) -> Result<(File, Metadata)> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, flags | libc::O_NONBLOCK);
    #[cfg(not(unix))]
    let _ = flags;
    let file = options.open(path)?;
    let there = file.metadata()?;
    match there.is_file() {
        true => Ok((file, there)),
        false if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
        false => Err(Error::other("it is not a plain file")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn a_file_is_opened_and_a_folder_a_pipe_or_a_link_is_not() {
        let folder = std::env::temp_dir().join(format!("foveal-plain-{}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        let [file, pipe, link] = ["file", "pipe", "link"].map(|name| folder.join(name));
        std::fs::write(&file, b"abc").unwrap();
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert_eq!(open_plain(&file).unwrap().1.len(), 3);
        assert_eq!(open_plain(&link).unwrap().1.len(), 3);
        assert!(open_unlinked(&file).is_ok());
        assert!(open_unlinked(&link).is_err());
        let folder_kind = open_plain(&folder).unwrap_err().kind();
        assert_eq!(folder_kind, ErrorKind::IsADirectory);
        if made.is_ok_and(|it| it.success()) {
            assert!(
                open_plain(&pipe)
                    .unwrap_err()
                    .to_string()
                    .contains("not a plain file")
            );
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_file_is_read_up_to_what_it_may_have_and_no_further() {
        let folder = std::env::temp_dir().join(format!("foveal-bounds-{}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        let file = folder.join("file");
        std::fs::write(&file, b"abcd").unwrap();
        assert_eq!(read_plain(&file, 4).unwrap(), b"abcd");
        let larger = read_plain(&file, 3).unwrap_err();
        assert_eq!(larger.kind(), ErrorKind::FileTooLarge);
        assert_eq!(first_bytes(&file, 3).unwrap(), b"abc");
        assert_eq!(first_bytes(&file, 9).unwrap(), b"abcd");
        if cfg!(target_os = "linux") {
            assert!(read_plain(Path::new("/dev/zero"), 9).is_err());
            // It says that it has no bytes, and has many.
            let told = read_plain(Path::new("/proc/self/status"), 9).unwrap_err();
            assert_eq!(told.kind(), ErrorKind::FileTooLarge);
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_name_that_is_taken_is_not_given_twice() {
        let folder = std::env::temp_dir().join(format!("foveal-names-{}", std::process::id()));
        std::fs::create_dir(&folder).unwrap();
        let [one, two, name] = ["one", "two", "name"].map(|it| folder.join(it));
        std::fs::write(&one, b"1").unwrap();
        std::fs::write(&two, b"2").unwrap();
        rename_new(&one, &name).unwrap();
        let taken = rename_new(&two, &name).unwrap_err();
        assert_eq!(taken.kind(), ErrorKind::AlreadyExists);
        assert_eq!(std::fs::read(&name).unwrap(), b"1");
        rename_durably(&two, &name).unwrap();
        assert_eq!(std::fs::read(&name).unwrap(), b"2");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
