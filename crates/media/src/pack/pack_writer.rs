//! How does a pack get onto disk whole or not at all?

use crate::pack::damage::Damage;
use crate::pack::journal_file::JournalFile;
use crate::pack::name_claim::{IfTaken, NameClaim, cannot_begin};
use crate::pack::pack_file::{PackFile, PackFileError};
use foveal_core::content::video::bytes::build::{
    begin_pack, finish_pack, push_tile, with_calibration, with_loss,
};
use foveal_core::content::video::bytes::description::{Description, Loss};
use foveal_core::content::video::calibration::Calibration;
use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_core::pack::PackBuilder;
use foveal_core::pack::{ChunkName, Identity, JournalStep, PackError, PackHead, SideTable};
use foveal_core::units::counted;
use std::fs::File;
use std::io::{BufWriter, Error, Seek, SeekFrom, Write};
use std::path::Path;

/// Writes a pack next to its final name and renames it when it is whole: a `prepare` that fails or
/// is killed never leaves a half pack under the final name.
#[derive(Debug)]
pub(crate) struct PackWriter {
    claim: NameClaim,
    file: BufWriter<File>,
    builder: PackBuilder,
    /// Where what is good is noted, for a pack that can be gone on with.
    journal: Option<JournalFile>,
    /// Chunks that it covers.
    journalled: usize,
    is_whole: bool,
}

/// What only a whole pack shows.
#[derive(Default)]
pub(crate) struct Inspected {
    /// What preparing lost.
    pub(crate) loss: Option<Loss>,
    /// Which score its content has at which bound.
    pub(crate) calibration: Option<Calibration>,
}

/// A pack as it is described, and with what is added to its end; both tails begin alike.
pub(crate) struct Looked {
    pub(crate) parts: PackHead,
    pub(crate) more: Option<PackHead>,
}

/// A pack that has its final name.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) bytes: u64,
    /// Why what was to be added to its end is missing.
    pub(crate) left_out: Option<Error>,
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
        let claim = NameClaim::of(path, IfTaken::Replace)?;
        Self::begin(claim, begin_pack(draft))
    }

    /// Begins a pack of any content, whose name was claimed.
    pub(crate) fn begin(mut claim: NameClaim, builder: PackBuilder) -> Result<Self, PackFileError> {
        let begun = JournalFile::begin(claim.partial(), Identity::default())
            .and_then(|_| begin_file(&mut claim, builder.data_offset()));
        let file = begun.map_err(|source| cannot_begin(claim.path(), source))?;
        Ok(Self::new(claim, file, builder, None))
    }

    /// Begins a pack that can be gone on with after any stop. With `go_on`, takes up what lies
    /// there of the same pack.
    pub(crate) fn resume(
        mut claim: NameClaim,
        draft: &Description,
        identity: Identity,
        go_on: bool,
    ) -> Result<Begun, PackFileError> {
        let (mut note, mut old) = (None, None);
        if let Some(mut file) = claim.take_rest() {
            let taken = if go_on {
                JournalFile::take_up(claim.partial(), &mut file, draft, &identity)
            } else {
                Err("--no-resume was given".to_owned())
            };
            match taken {
                Ok((journal, unfinished)) => {
                    let frames = unfinished.steps.last().map_or(0, |step| step.frames);
                    let mut writer = Self::new(claim, file, unfinished.builder, Some(journal));
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
                Err(why) => {
                    note = Some(format!("starting over: {why}"));
                    old = Some(file);
                }
            }
        }
        let builder = begin_pack(draft);
        let begin = || {
            let journal = JournalFile::begin(claim.partial(), identity)?;
            let file = begin_file(&mut claim, builder.data_offset())?;
            Ok((journal, file))
        };
        let begun = begin();
        let (journal, file) = begun.map_err(|source| cannot_begin(claim.path(), source))?;
        // Until now it was locked, so that no other process took it up.
        drop(old);
        Ok(Begun {
            writer: Self::new(claim, file, builder, Some(journal)),
            steps: Vec::new(),
            note,
        })
    }

    fn new(
        claim: NameClaim,
        file: File,
        builder: PackBuilder,
        journal: Option<JournalFile>,
    ) -> Self {
        Self {
            claim,
            file: BufWriter::with_capacity(1 << 20, file),
            builder,
            journal,
            journalled: 0,
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

    /// Writes the rest, makes it durable, reads it back and gives it its final name. Before that,
    /// `inspect` sees the whole pack.
    pub(crate) fn finish(
        self,
        description: Description,
        tables: &[SideTable],
        inspect: &mut dyn FnMut(&Path) -> Inspected,
    ) -> Result<(Description, Ended), PackFileError> {
        let mut loss = None;
        let finish = |builder| finish_pack(builder, description.clone(), tables);
        let look = |mut parts, partial: &Path| {
            let found = inspect(partial);
            loss = found.loss;
            if let Some(loss) = loss {
                parts = with_loss(parts, loss)?;
            }
            let add = |calibration| with_calibration(parts.clone(), &calibration);
            let more = found.calibration.map(add).transpose()?;
            Ok(Looked { parts, more })
        };
        let check = |partial: &Path| Ok(PackFile::open(partial)?.verify(|_, _| ()));
        let ended = self.end(finish, look, check)?;
        let description = Description {
            loss,
            ..description
        };
        Ok((description, ended))
    }

    /// Writes what `finish` makes of all chunks, makes it durable and gives it its final name.
    /// Before that `look` sees the whole pack, may describe it otherwise and add to its end, and
    /// `check` reads it back and reports what is damaged.
    pub(crate) fn end(
        mut self,
        finish: impl FnOnce(PackBuilder) -> Result<PackHead, PackError>,
        look: impl FnOnce(PackHead, &Path) -> Result<Looked, PackError>,
        check: impl FnOnce(&Path) -> Result<Damage, PackFileError>,
    ) -> Result<Ended, PackFileError> {
        let chunk_bytes = self.builder.end();
        let builder = std::mem::replace(&mut self.builder, PackBuilder::new(&[]));
        let format = |path: &Path| {
            let path = path.to_owned();
            move |source| PackFileError::Format { path, source }
        };
        let parts = finish(builder).map_err(format(self.claim.path()))?;
        let whole = self.file.write_all(&parts.tail);
        let whole = whole.and_then(|()| self.write_head(&parts.head));
        whole.map_err(|source| self.refused(source))?;
        let looked = look(parts, self.claim.partial()).map_err(format(self.claim.path()))?;
        let bytes = chunk_bytes + looked.parts.tail.len() as u64;
        let on_disk = self.write_end(bytes, &looked);
        let ended = on_disk.map_err(|source| self.refused(source))?;
        let damage = check(self.claim.partial()).map_err(|error| self.unreadable(&error))?;
        if let Some(first) = damage.first().first() {
            return Err(self.unreadable(first));
        }
        let named = self.claim.give_name();
        named.map_err(|source| self.refused(source))?;
        self.is_whole = true;
        if let Some(journal) = &mut self.journal {
            journal.remove();
        }
        Ok(ended)
    }

    /// Writes the description of a pack of so many bytes, and what is added behind it; where there
    /// is no room for that, the pack stays without.
    fn write_end(&mut self, bytes: u64, looked: &Looked) -> Result<Ended, Error> {
        self.write_head(&looked.parts.head)?;
        let mut ended = Ended {
            bytes,
            left_out: None,
        };
        if let Some(more) = &looked.more {
            let added = &more.tail[looked.parts.tail.len()..];
            match self.add(bytes, added, &more.head) {
                Ok(()) => ended.bytes += added.len() as u64,
                Err(why) => {
                    self.file.get_mut().set_len(bytes)?;
                    self.write_head(&looked.parts.head)?;
                    ended.left_out = Some(why);
                }
            }
        }
        self.file.get_ref().sync_all()?;
        Ok(ended)
    }

    /// Adds bytes behind a whole pack, and a description that names them once they are on disk.
    fn add(&mut self, at: u64, bytes: &[u8], head: &[u8]) -> Result<(), Error> {
        // Without a buffer, which would keep what the disk refuses and try it again.
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(at))?;
        file.write_all(bytes)?;
        file.sync_data()?;
        self.write_head(head)
    }

    /// What was written is not what can be read.
    fn unreadable(&self, error: &PackFileError) -> PackFileError {
        PackFileError::Io {
            path: self.claim.path().to_owned(),
            what: format!(
                "was written and cannot be read back; check the disk, or choose another --out \
                 ({})",
                self.left()
            ),
            source: Error::other(error.reason()),
        }
    }

    fn write_head(&mut self, head: &[u8]) -> Result<(), Error> {
        self.file.seek(SeekFrom::Start(0))?;
        self.file.write_all(head)?;
        self.file.flush()
    }

    fn refused(&self, source: Error) -> PackFileError {
        let left = self.left();
        PackFileError::Io {
            path: self.claim.path().to_owned(),
            what: format!(
                "cannot be written after {}; free space there or choose another --out \
                 ({left})",
                counted(self.builder.end(), "byte")
            ),
            source,
        }
    }

    fn left(&self) -> &'static str {
        match self.can_go_on() {
            true => "the same command then goes on where it was",
            false => "nothing was left behind",
        }
    }

    /// Whether what lies there is worth keeping.
    fn can_go_on(&self) -> bool {
        self.journal.as_ref().is_some_and(JournalFile::has_steps)
    }
}

/// Puts the file at the place of its first chunk.
fn begin_file(claim: &mut NameClaim, data_offset: u64) -> Result<File, Error> {
    let mut file = claim.take_empty()?;
    file.seek(SeekFrom::Start(data_offset))?;
    Ok(file)
}

impl Drop for PackWriter {
    fn drop(&mut self) {
        if self.is_whole || self.can_go_on() {
            return;
        }
        // A half file that nothing can be made of is of no use.
        let _ = std::fs::remove_file(self.claim.partial());
        if let Some(journal) = &mut self.journal {
            journal.remove();
        }
    }
}
