//! How does a preparation that was stopped go on where it was?
//!
//! Next to a pack that grows lies a journal ([`foveal_core::pack::Journal`]) that says how
//! far the pack is good. It is made at the first step and goes away when the pack is whole, so
//! there is
//! at most one for each name of a pack.

use crate::plain_file::open_unlinked;
use foveal_core::content::video::bytes::build::begin_pack;
use foveal_core::content::video::bytes::chunk::named_chunk;
use foveal_core::content::video::bytes::description::Description;
use foveal_core::content::video::grid::tile_grid::TileGrid;
use foveal_core::pack::PackBuilder;
use foveal_core::pack::{
    Difference, Identity, JOURNAL_MAGIC, Journal, JournalStep, PlacedChunk, check_crc,
};
use foveal_core::view::surface::Screen;
use std::fs::File;
use std::io::{BufReader, Error, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Longest journal that is read, bytes: about 40 million chunks.
const MOST_BYTES: u64 = 1 << 30;

/// The journal of a pack that grows.
#[derive(Debug)]
pub(crate) struct JournalFile {
    path: PathBuf,
    identity: Identity,
    /// None until the first step.
    file: Option<File>,
}

/// What is good of a pack that was begun before.
pub(crate) struct Unfinished {
    pub(crate) steps: Vec<JournalStep>,
    pub(crate) builder: PackBuilder,
}

/// Name of the journal of a pack that grows as `partial`.
pub(crate) fn journal_path(partial: &Path) -> PathBuf {
    let mut name = partial.file_name().unwrap_or_default().to_owned();
    name.push(".journal");
    partial.with_file_name(name)
}

impl JournalFile {
    /// The journal of a new pack; what lies there from another one goes away.
    pub(crate) fn begin(partial: &Path, identity: Identity) -> Result<Self, Error> {
        let path = journal_path(partial);
        if std::fs::symlink_metadata(&path).is_ok() {
            if !is_journal(&path) {
                let name = path.display();
                let why = format!("{name} is in the way: it is no journal; move it away");
                return Err(Error::other(why));
            }
            std::fs::remove_file(&path)?;
        }
        Ok(Self {
            path,
            identity,
            file: None,
        })
    }

    /// Takes up the journal of `partial`: what of it is good and is what `identity` asks for; both
    /// files end after that. Else says why not.
    pub(crate) fn take_up(
        partial: &Path,
        file: &mut File,
        draft: &Description,
        identity: &Identity,
    ) -> Result<(Self, Unfinished), String> {
        let path = journal_path(partial);
        let bytes = read_journal(&path)?;
        let journal =
            Journal::parse(&bytes).map_err(|e| format!("its journal is damaged ({e})"))?;
        if let Some(difference) = journal.identity.difference(identity) {
            let why = match difference {
                Difference::Program => "another version of the program began it",
                Difference::Input => "the input has changed",
                Difference::Settings => "it was begun with other settings",
            };
            return Err(why.to_owned());
        }
        let unfinished = good_part(journal, file, draft);
        if unfinished.steps.is_empty() {
            return Err("nothing reusable was found".to_owned());
        }
        let good = identity.write().len()
            + unfinished
                .steps
                .iter()
                .map(|step| step.write().len())
                .sum::<usize>();
        let mut cut = || {
            file.set_len(unfinished.builder.end())?;
            file.seek(SeekFrom::End(0))?;
            let mut journal = File::options().write(true).open(&path)?;
            journal.set_len(good as u64)?;
            journal.seek(SeekFrom::End(0))?;
            Ok(journal)
        };
        let opened = cut().map_err(|e: Error| format!("it cannot be taken up: {e}"))?;
        let this = Self {
            path,
            identity: identity.clone(),
            file: Some(opened),
        };
        Ok((this, unfinished))
    }

    /// Appends a step and makes it durable.
    pub(crate) fn append(&mut self, step: &JournalStep) -> Result<(), Error> {
        let mut file = match self.file.take() {
            Some(file) => file,
            None => {
                let mut file = File::options()
                    .write(true)
                    .create_new(true)
                    .open(&self.path)?;
                file.write_all(&self.identity.write())?;
                file
            }
        };
        file.write_all(&step.write())?;
        file.sync_data()?;
        self.file = Some(file);
        Ok(())
    }

    /// Whether there is a step to go on from.
    pub(crate) fn has_steps(&self) -> bool {
        self.file.is_some()
    }

    /// Removes the journal: its pack is whole, or gone.
    pub(crate) fn remove(&mut self) {
        self.file = None;
        // Where none was made there is nothing to remove.
        let _ = std::fs::remove_file(&self.path);
    }
}

fn is_journal(path: &Path) -> bool {
    let mut begins = Vec::new();
    let read = open_unlinked(path).and_then(|(file, _)| file.take(8).read_to_end(&mut begins));
    read.is_ok() && (begins == JOURNAL_MAGIC || begins.iter().all(|byte| *byte == 0))
}

fn read_journal(path: &Path) -> Result<Vec<u8>, String> {
    let none = |e: Error| match e.kind() {
        ErrorKind::NotFound => "nothing reusable was found".to_owned(),
        _ => format!("{}: {e}", path.display()),
    };
    let (mut file, there) = open_unlinked(path).map_err(none)?;
    if there.len() > MOST_BYTES {
        return Err(format!("{} is no journal", path.display()));
    }
    let mut bytes = Vec::new();
    let mut bounded = (&mut file).take(MOST_BYTES);
    bounded.read_to_end(&mut bytes).map_err(none)?;
    Ok(bytes)
}

/// The steps up to the first whose frames, tiles or bytes in the pack are not as they should be.
fn good_part(journal: Journal, file: &File, draft: &Description) -> Unfinished {
    let mut builder = begin_pack(draft);
    let grid = draft.grid(Screen::default());
    let mut reader = BufReader::with_capacity(1 << 20, file);
    let mut frames = 0;
    let mut steps = Vec::new();
    if reader.seek(SeekFrom::Start(builder.data_offset())).is_err() {
        return Unfinished { steps, builder };
    }
    for step in journal.steps {
        if !continues(&step, frames, &grid) || !is_in_pack(&step, &mut reader) {
            break;
        }
        frames = step.frames;
        step.chunks.iter().for_each(|chunk| builder.take_up(*chunk));
        steps.push(step);
    }
    Unfinished { steps, builder }
}

/// Whether a step is for the frames that follow `frames`, in tiles of the grid.
fn continues(step: &JournalStep, frames: u32, grid: &TileGrid) -> bool {
    let new = step.frames.checked_sub(frames).map(|new| new as usize);
    let exists = |chunk: &PlacedChunk| {
        let (tile, first_frame) = named_chunk(chunk.name);
        tile.level < grid.levels
            && u32::from(tile.face) < grid.surface.faces()
            && u32::from(tile.x) < grid.tiles(tile.level)[0]
            && u32::from(tile.y) < grid.tiles(tile.level)[1]
            && (frames..step.frames).contains(&first_frame)
    };
    new.is_some_and(|new| new > 0 && new == step.times.len()) && step.chunks.iter().all(exists)
}

/// Whether the chunks of a step lie in the pack undamaged.
fn is_in_pack(step: &JournalStep, reader: &mut BufReader<&File>) -> bool {
    let mut chunk = Vec::new();
    step.chunks.iter().all(|placed| {
        chunk.clear();
        let read = reader
            .by_ref()
            .take(u64::from(placed.bytes))
            .read_to_end(&mut chunk);
        read.is_ok_and(|read| read == placed.bytes as usize)
            && check_crc("chunk", &chunk, placed.crc32c).is_ok()
    })
}
