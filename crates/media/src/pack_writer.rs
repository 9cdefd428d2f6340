//! How does a pack get onto disk whole or not at all?

use crate::pack_file::{PackFileError, partial_path};
use foveal_core::asset::pack::{Description, MAGIC, PackBuilder, SideTable};
use foveal_core::asset::tile_grid::Tile;
use std::fs::File;
use std::io::{BufWriter, Error, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Writes a pack beside its final name and renames it when it is whole: a `prepare` that fails or
/// is killed never leaves a half pack under the final name.
#[derive(Debug)]
pub(crate) struct PackWriter {
    path: PathBuf,
    partial: PathBuf,
    file: BufWriter<File>,
    builder: PackBuilder,
    bytes: u64,
}

impl PackWriter {
    /// Begins a pack of about this description: the number of frames and the side tables may
    /// still change.
    pub(crate) fn create(path: &Path, draft: &Description) -> Result<Self, PackFileError> {
        let partial = partial_path(path);
        let builder = PackBuilder::new(draft);
        let begin = || {
            refuse_anything_but_a_file(path)?;
            let mut file = create_partial(&partial)?;
            file.seek(SeekFrom::Start(builder.data_offset()))?;
            Ok(file)
        };
        let file = begin().map_err(|source| PackFileError::Io {
            path: path.to_owned(),
            what: "cannot be written; choose another --out".to_owned(),
            source,
        })?;
        let bytes = builder.data_offset();
        let file = BufWriter::with_capacity(1 << 20, file);
        Ok(Self {
            path: path.to_owned(),
            partial,
            file,
            builder,
            bytes,
        })
    }

    /// Writes the next chunk: the access units of `tile` from `first_frame` on.
    pub(crate) fn push(
        &mut self,
        tile: Tile,
        first_frame: u32,
        access_units: &[Vec<u8>],
    ) -> Result<(), PackFileError> {
        let chunk = self.builder.push(tile, first_frame, access_units);
        let written = self.file.write_all(&chunk);
        written.map_err(|source| self.refused(source))?;
        self.bytes += chunk.len() as u64;
        Ok(())
    }

    /// Writes the rest, makes it durable and gives it its final name. Returns its bytes.
    pub(crate) fn finish(
        mut self,
        description: Description,
        tables: &[SideTable],
    ) -> Result<u64, PackFileError> {
        let builder = std::mem::replace(&mut self.builder, PackBuilder::new(&description));
        let parts =
            builder
                .finish(description, tables)
                .map_err(|source| PackFileError::Format {
                    path: self.path.clone(),
                    source,
                })?;
        let mut end = || {
            self.file.write_all(&parts.tail)?;
            self.file.seek(SeekFrom::Start(0))?;
            self.file.write_all(&parts.head)?;
            self.file.flush()?;
            self.file.get_ref().sync_all()?;
            std::fs::rename(&self.partial, &self.path)
        };
        end().map_err(|source| self.refused(source))?;
        Ok(self.bytes + parts.tail.len() as u64)
    }

    fn refused(&self, source: Error) -> PackFileError {
        PackFileError::Io {
            path: self.path.clone(),
            what: format!(
                "cannot be written after {} bytes; free space there or choose another --out \
                 (nothing was left behind)",
                self.bytes
            ),
            source,
        }
    }
}

/// A rename would put the pack in the place of a device such as /dev/null, or of a link.
fn refuse_anything_but_a_file(path: &Path) -> Result<(), Error> {
    match std::fs::symlink_metadata(path) {
        Ok(there) if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(there) if there.is_symlink() => Err(Error::other("it is a link; name its target")),
        Ok(there) if !there.is_file() => Err(Error::other("it is no plain file")),
        _ => Ok(()),
    }
}

/// Creates the file that grows, and locks it for as long as it is open.
///
/// What lies there already is replaced only if it is the rest of a `prepare` that was killed:
/// never a link, somebody else's file, or one that another `prepare` is writing.
fn create_partial(partial: &Path) -> Result<File, Error> {
    if std::fs::symlink_metadata(partial).is_ok() {
        let name = partial.display();
        let in_the_way = |why: &str| Error::other(format!("{name} is in the way: {why}"));
        let there = std::fs::symlink_metadata(partial)?;
        if !there.is_file() {
            return Err(in_the_way("it is no plain file"));
        }
        let mut file = File::options().read(true).write(true).open(partial)?;
        if file.try_lock().is_err() {
            return Err(in_the_way("another prepare is writing it"));
        }
        let mut begins = Vec::new();
        (&mut file)
            .take(MAGIC.len() as u64)
            .read_to_end(&mut begins)?;
        if begins != MAGIC && begins.iter().any(|byte| *byte != 0) {
            return Err(in_the_way("it is no half-written pack; move it away"));
        }
        std::fs::remove_file(partial)?;
    }
    let file = File::options().write(true).create_new(true).open(partial)?;
    file.try_lock().map_err(|_| ErrorKind::ResourceBusy)?;
    Ok(file)
}

impl Drop for PackWriter {
    fn drop(&mut self) {
        // After a rename there is nothing to remove; after a failure a half file is of no use.
        let _ = std::fs::remove_file(&self.partial);
    }
}
