//! How does a pack get onto disk whole or not at all?

use crate::pack::journal_file::JournalFile;
use crate::pack::pack_file::{PackFileError, partial_path};
use crate::plain_file::rename_durably;
use foveal_core::content::video::bytes::build::{begin_pack, finish_pack, push_tile, with_loss};
use foveal_core::content::video::bytes::description::{Description, Loss};
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::PackBuilder;
use foveal_core::pack::{ChunkName, Identity, JournalStep, MAGIC, PackError, PackHead, SideTable};
use foveal_core::units::counted;
use std::fs::File;
use std::io::{BufWriter, Error, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Writes a pack beside its final name and renames it when it is whole: a `prepare` that fails or
/// is killed never leaves a half pack under the final name.
#[derive(Debug)]
pub(crate) struct PackWriter {
    path: PathBuf,
    partial: PathBuf,
    file: BufWriter<File>,
    builder: PackBuilder,
    /// Where what is good is noted, for a pack that can be gone on with.
    journal: Option<JournalFile>,
    /// Chunks that it tells of.
    journalled: usize,
    /// When what lay under the final name at the beginning was last changed.
    replaced: Option<SystemTime>,
    is_whole: bool,
}

/// A writer, what was good of a pack that was begun before, and what a person should know of it.
pub(crate) struct Begun {
    pub(crate) writer: PackWriter,
    pub(crate) steps: Vec<JournalStep>,
    pub(crate) note: Option<String>,
}

impl PackWriter {
    /// Begins a pack of about this description: the number of frames and the side tables may
    /// still change.
    pub(crate) fn create(path: &Path, draft: &Description) -> Result<Self, PackFileError> {
        Self::begin(path, begin_pack(draft))
    }

    /// Begins a pack of any content.
    pub(crate) fn begin(path: &Path, builder: PackBuilder) -> Result<Self, PackFileError> {
        let partial = partial_path(path);
        let begin = || {
            refuse_anything_but_a_file(path)?;
            remove_rest(&partial)?;
            create_partial(&partial, builder.data_offset())
        };
        let file = begin().map_err(|source| cannot_begin(path, source))?;
        Ok(Self::new(path, file, builder, None))
    }

    /// Begins a pack that can be gone on with after any stop. With `go_on`, takes up what lies
    /// there of the same pack.
    pub(crate) fn resume(
        path: &Path,
        draft: &Description,
        identity: Identity,
        go_on: bool,
    ) -> Result<Begun, PackFileError> {
        let refused = |source| cannot_begin(path, source);
        let partial = partial_path(path);
        refuse_anything_but_a_file(path).map_err(refused)?;
        let there = open_rest(&partial).map_err(refused)?;
        let mut note = None;
        if let Some(mut file) = there {
            let taken = if go_on {
                JournalFile::take_up(&partial, &mut file, draft, &identity)
            } else {
                Err("--no-resume was given".to_owned())
            };
            match taken {
                Ok((journal, unfinished)) => {
                    let frames = unfinished.steps.last().map_or(0, |step| step.frames);
                    let mut writer = Self::new(path, file, unfinished.builder, Some(journal));
                    writer.journalled = writer.builder.len();
                    return Ok(Begun {
                        writer,
                        steps: unfinished.steps,
                        note: Some(format!(
                            "goes on after {} coded before",
                            counted(frames, "frame")
                        )),
                    });
                }
                Err(why) => note = Some(format!("starts afresh: {why}")),
            }
            std::fs::remove_file(&partial).map_err(refused)?;
        }
        let builder = begin_pack(draft);
        let journal = JournalFile::begin(&partial, identity).map_err(refused)?;
        let file = create_partial(&partial, builder.data_offset()).map_err(refused)?;
        Ok(Begun {
            writer: Self::new(path, file, builder, Some(journal)),
            steps: Vec::new(),
            note,
        })
    }

    fn new(path: &Path, file: File, builder: PackBuilder, journal: Option<JournalFile>) -> Self {
        Self {
            path: path.to_owned(),
            partial: partial_path(path),
            file: BufWriter::with_capacity(1 << 20, file),
            builder,
            journal,
            journalled: 0,
            replaced: last_change(path),
            is_whole: false,
        }
    }

    /// Writes the next chunk: the access units of `tile` from `first_frame` on.
    pub(crate) fn push(
        &mut self,
        tile: Tile,
        first_frame: u32,
        access_units: &[Vec<u8>],
    ) -> Result<(), PackFileError> {
        let chunk = push_tile(&mut self.builder, tile, first_frame, access_units);
        let written = self.file.write_all(&chunk);
        written.map_err(|source| self.refused(source))
    }

    /// Writes the next chunk of any content.
    pub(crate) fn push_chunk(
        &mut self,
        name: ChunkName,
        chunk: &[u8],
    ) -> Result<(), PackFileError> {
        self.builder.push(name, chunk);
        let written = self.file.write_all(chunk);
        written.map_err(|source| self.refused(source))
    }

    /// Makes durable what was pushed so far and notes that it is good.
    pub(crate) fn commit(&mut self, step: JournalStep) -> Result<(), PackFileError> {
        let Some(journal) = &mut self.journal else {
            return Ok(());
        };
        let step = JournalStep {
            chunks: self.builder.chunks_after(self.journalled),
            ..step
        };
        let mut note = || {
            self.file.flush()?;
            self.file.get_ref().sync_data()?;
            journal.append(&step)
        };
        let noted = note();
        noted.map_err(|source| self.refused(source))?;
        self.journalled = self.builder.len();
        Ok(())
    }

    /// Writes the rest, makes it durable and gives it its final name. Before that, the whole pack
    /// is shown to whoever tells what was lost. Returns its description and bytes.
    pub(crate) fn finish(
        self,
        description: Description,
        tables: &[SideTable],
        loss_of: &mut dyn FnMut(&Path) -> Option<Loss>,
    ) -> Result<(Description, u64), PackFileError> {
        let mut loss = None;
        let finish = |builder| finish_pack(builder, description.clone(), tables);
        let bytes = self.end(finish, |parts, partial| {
            loss = loss_of(partial);
            match loss {
                Some(loss) => with_loss(parts, loss),
                None => Ok(parts),
            }
        })?;
        let description = Description {
            loss,
            ..description
        };
        Ok((description, bytes))
    }

    /// Writes what `finish` makes of all chunks, makes it durable and gives it its final name;
    /// before that `look` sees the whole pack, and may describe it otherwise. Returns its bytes.
    pub(crate) fn end(
        mut self,
        finish: impl FnOnce(PackBuilder) -> Result<PackHead, PackError>,
        look: impl FnOnce(PackHead, &Path) -> Result<PackHead, PackError>,
    ) -> Result<u64, PackFileError> {
        let chunk_bytes = self.builder.end();
        let builder = std::mem::replace(&mut self.builder, PackBuilder::new(&[]));
        let format = |path: &Path| {
            let path = path.to_owned();
            move |source| PackFileError::Format { path, source }
        };
        let parts = finish(builder).map_err(format(&self.path))?;
        let whole = self.file.write_all(&parts.tail);
        let whole = whole.and_then(|()| self.write_head(&parts.head));
        whole.map_err(|source| self.refused(source))?;
        let parts = look(parts, &self.partial).map_err(format(&self.path))?;
        let mut end = || {
            self.write_head(&parts.head)?;
            self.file.get_ref().sync_all()?;
            if last_change(&self.path) != self.replaced {
                return Err(Error::other("another file has taken its name meanwhile"));
            }
            rename_durably(&self.partial, &self.path)
        };
        end().map_err(|source| self.refused(source))?;
        self.is_whole = true;
        if let Some(journal) = &mut self.journal {
            journal.remove();
        }
        Ok(chunk_bytes + parts.tail.len() as u64)
    }

    fn write_head(&mut self, head: &[u8]) -> Result<(), Error> {
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(head)?;
        self.file.flush()
    }

    fn refused(&self, source: Error) -> PackFileError {
        let left = if self.can_go_on() {
            "the same command then goes on where it was"
        } else {
            "nothing was left behind"
        };
        PackFileError::Io {
            path: self.path.clone(),
            what: format!(
                "cannot be written after {}; free space there or choose another --out \
                 ({left})",
                counted(self.builder.end(), "byte")
            ),
            source,
        }
    }

    /// Whether what lies there is worth keeping.
    fn can_go_on(&self) -> bool {
        self.journal.as_ref().is_some_and(JournalFile::has_steps)
    }
}

fn last_change(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path)
        .and_then(|there| there.modified())
        .ok()
}

fn cannot_begin(path: &Path, source: Error) -> PackFileError {
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
        Ok(there) if !there.is_file() => Err(Error::other("it is no plain file")),
        _ => Ok(()),
    }
}

/// Creates the file that grows, up to its first chunk, and locks it for as long as it is open.
fn create_partial(partial: &Path, data_offset: u64) -> Result<File, Error> {
    let mut options = File::options();
    let mut file = options
        .read(true)
        .write(true)
        .create_new(true)
        .open(partial)?;
    file.try_lock().map_err(|_| ErrorKind::ResourceBusy)?;
    file.seek(SeekFrom::Start(data_offset))?;
    Ok(file)
}

/// Removes the rest of a `prepare` that was stopped, and its journal.
fn remove_rest(partial: &Path) -> Result<(), Error> {
    if open_rest(partial)?.is_some() {
        std::fs::remove_file(partial)?;
    }
    JournalFile::begin(partial, Identity::default()).map(|_| ())
}

/// Opens and locks the rest of a `prepare` that was stopped; `None` where nothing lies.
///
/// Refuses a link, somebody else's file, and one that another `prepare` is writing.
fn open_rest(partial: &Path) -> Result<Option<File>, Error> {
    let Ok(there) = std::fs::symlink_metadata(partial) else {
        return Ok(None);
    };
    let name = partial.display();
    let in_the_way = |why: &str| Error::other(format!("{name} is in the way: {why}"));
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
    Ok(Some(file))
}

impl Drop for PackWriter {
    fn drop(&mut self) {
        if self.is_whole || self.can_go_on() {
            return;
        }
        // A half file that nothing can be made of is of no use.
        let _ = std::fs::remove_file(&self.partial);
        if let Some(journal) = &mut self.journal {
            journal.remove();
        }
    }
}
