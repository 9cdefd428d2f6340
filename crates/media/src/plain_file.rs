//! How is a file opened, whatever takes its place meanwhile?

use std::fs::{File, Metadata, OpenOptions};
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// Opens a file for reading. What is opened is judged, not what lay there before, and opening waits
/// for nobody, as opening a pipe would.
///
/// # Errors
/// It cannot be opened, is a folder, or no plain file.
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

/// Gives a file another name once its bytes are on disk, and makes the name durable, which is in
/// its folder.
///
/// # Errors
/// It cannot be renamed, or its folder not be written.
pub fn rename_durably(from: &Path, to: &Path) -> Result<()> {
    File::open(from)?.sync_all()?;
    std::fs::rename(from, to)?;
    let folder = to.parent().filter(|it| !it.as_os_str().is_empty());
    // Elsewhere than on Unix a folder cannot be opened.
    #[cfg(unix)]
    File::open(folder.unwrap_or(Path::new(".")))?.sync_all()?;
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
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
        false => Err(Error::other("it is no plain file")),
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
                    .contains("no plain file")
            );
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
