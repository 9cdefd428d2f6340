//! How is a pack read from a file?

use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::bytes::cue_table::{CUES, CueTable};
use foveal_core::content::video::bytes::frame_times::{
    FRAME_TIMES, nominal_times, parse_frame_times,
};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::content::video::bytes::signatures::{SIGNATURES, Signatures};
use foveal_core::content::video::bytes::sound::{SOUND, SoundTable};
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{HEADER_BYTES, Header, PackError, TableEntry, check_crc};
use foveal_core::units::counted;
use foveal_core::view::surface::Screen;
use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use thiserror::Error;

/// What failed, why, and then what to do, which `what` tells behind a semicolon.
fn with_cause(what: &str, cause: &std::io::Error) -> String {
    match what.split_once("; ") {
        Some((what, next)) => format!("{what}: {cause}; {next}"),
        None => format!("{what}: {cause}"),
    }
}

/// Why a pack cannot be read, and what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PackFileError {
    /// The system refuses.
    #[error("{}: {}", path.display(), with_cause(what, source))]
    Io {
        /// The pack.
        path: PathBuf,
        /// What was being done.
        what: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// There is something else in its place.
    #[error("{}: {what}; give a pack, as `foveal prepare` writes it", path.display())]
    NoFile {
        /// Where the pack was to be.
        path: PathBuf,
        /// What is there.
        what: &'static str,
    },
    /// The bytes are no pack, or damaged.
    #[error("{}: {source}{}", path.display(), advice(path, source))]
    Format {
        /// The pack.
        path: PathBuf,
        /// The field that is wrong.
        source: PackError,
    },
}

/// What to do about bytes that are no pack of this version.
fn advice(path: &Path, error: &PackError) -> String {
    match error.field.as_str() {
        "magic" => format!(
            "; if it is a video, make a pack of it: `foveal prepare video {} --out PACK`",
            path.display()
        ),
        // The error itself says what to update.
        "version" => String::new(),
        _ => "; if it was copied, copy it again, else prepare it again from its source".to_owned(),
    }
}

/// An open pack: description and index in memory, chunks read when they are asked for.
#[derive(Debug)]
pub struct PackFile {
    path: PathBuf,
    // One cursor is shared by all readers: a read is a seek and a copy, far cheaper than decoding.
    file: Mutex<File>,
    header: Header,
    pack: Arc<VideoPack>,
}

impl PackFile {
    /// Opens a pack and reads its header, description and index.
    pub fn open(path: &Path) -> Result<Self, PackFileError> {
        let io = |what: &str, source| PackFileError::Io {
            path: path.to_owned(),
            what: what.to_owned(),
            source,
        };
        let format = |source| PackFileError::Format {
            path: path.to_owned(),
            source,
        };
        let found = std::fs::metadata(path).map_err(|e| io("cannot be opened", e))?;
        if !found.is_file() {
            let what = if found.is_dir() {
                "is a folder"
            } else {
                "is no plain file"
            };
            return Err(PackFileError::NoFile {
                path: path.to_owned(),
                what,
            });
        }
        let mut file = File::open(path).map_err(|e| io("cannot be opened", e))?;
        let mut head = Vec::new();
        let mut first = (&mut file).take(HEADER_BYTES as u64);
        first
            .read_to_end(&mut head)
            .map_err(|e| io("header cannot be read", e))?;
        let header = Header::parse(&head).map_err(format)?;
        if header.file_bytes != found.len() {
            return Err(format(PackError {
                field: "file_bytes".to_owned(),
                found: format!("a file of {}", counted(found.len(), "byte")),
                expected: format!("{} (cut short or with something added)", header.file_bytes),
            }));
        }
        let mut part = |offset, bytes| read_at(&mut file, offset, bytes);
        let description = part(HEADER_BYTES as u64, u64::from(header.description_bytes))
            .map_err(|e| io("description cannot be read", e))?;
        let expected = VideoPack::expected_index_bytes(&description).map_err(format)?;
        if header.index_bytes != expected {
            return Err(format(PackError {
                field: "index_bytes".to_owned(),
                found: header.index_bytes.to_string(),
                expected: expected.to_string(),
            }));
        }
        let index = part(header.index_offset, header.index_bytes)
            .map_err(|e| io("index cannot be read", e))?;
        let pack = VideoPack::parse(&header, &description, &index).map_err(format)?;
        Ok(Self {
            path: path.to_owned(),
            file: Mutex::new(file),
            header,
            pack: Arc::new(pack),
        })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its description and index.
    #[must_use]
    pub fn pack(&self) -> &VideoPack {
        &self.pack
    }

    /// The video with the side tables by which units are chosen, flat content filling `screen`.
    ///
    /// # Errors
    /// A table is damaged.
    pub fn video(&self, screen: Screen) -> Result<Arc<Video>, PackFileError> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let video = Video::new(&name, Arc::clone(&self.pack), screen);
        for name in [FRAME_TIMES, SIGNATURES, CUES] {
            if let Some(table) = video.table(name) {
                let added = video.add_table(name, self.read_table(table)?);
                added.map_err(|source| self.format(source))?;
            }
        }
        Ok(Arc::new(video))
    }

    /// Bytes of the file.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.header.file_bytes
    }

    /// The chunk of a unit, its checksum checked.
    pub fn read_chunk(&self, unit: UnitId) -> Result<Vec<u8>, PackFileError> {
        let entry = self.pack.entry(unit);
        let what = || {
            let (tile, frames) = (self.pack.tile_of(unit), self.pack.frames_of(unit));
            format!(
                "chunk of level {}, face {}, column {}, row {}, frames {}-{}",
                tile.level,
                tile.face,
                tile.x,
                tile.y,
                frames.start,
                frames.end - 1
            )
        };
        let bytes = self.read(entry.offset, u64::from(entry.bytes), &what)?;
        let checked = check_crc(&what(), &bytes, entry.crc32c);
        checked
            .map(|()| bytes)
            .map_err(|source| self.format(source))
    }

    /// Time of every frame in nanoseconds after the first, from the side table `frame_times`.
    pub fn frame_times(&self) -> Result<Vec<i64>, PackFileError> {
        let about = self.pack.description();
        let parse = |version, rows: Vec<u8>| parse_frame_times(about.frames, version, &rows);
        let times = self.parse_table(FRAME_TIMES, parse)?;
        Ok(times.unwrap_or_else(|| nominal_times(about)))
    }

    /// What each unit adds, from the side table `signatures`; `None` where the pack has none.
    pub fn signatures(&self) -> Result<Option<Signatures>, PackFileError> {
        let parse = |version, rows| Signatures::parse(&self.pack, version, rows);
        self.parse_table(SIGNATURES, parse)
    }

    /// What might draw the eye, from the side table `cues`; `None` where the pack has none.
    pub fn cues(&self) -> Result<Option<CueTable>, PackFileError> {
        let parse = |version, rows| CueTable::parse(&self.pack, version, rows);
        self.parse_table(CUES, parse)
    }

    /// The sound, from the side table `sound`, as it is coded; `None` where the pack has none.
    pub fn sound(&self) -> Result<Option<SoundTable>, PackFileError> {
        self.parse_table(SOUND, |version, bytes| SoundTable::parse(version, &bytes))
    }

    fn parse_table<T>(
        &self,
        name: &str,
        parse: impl FnOnce(u32, Vec<u8>) -> Result<T, PackError>,
    ) -> Result<Option<T>, PackFileError> {
        let tables = &self.pack.description().tables;
        let Some(table) = tables.iter().find(|table| table.name == name) else {
            return Ok(None);
        };
        let rows = self.read_table(table)?;
        let parsed = parse(table.version, rows);
        parsed.map(Some).map_err(|source| self.format(source))
    }

    /// Reads every byte and checks it: `progress` is told how many bytes are done of how many.
    /// Returns what is damaged, nothing if all is well.
    pub fn verify(&self, mut progress: impl FnMut(u64, u64)) -> Vec<PackFileError> {
        let mut damage = Vec::new();
        if let Err(source) = self.pack.check_coverage(&self.header) {
            damage.push(self.format(source));
        }
        for table in &self.pack.description().tables {
            damage.extend(self.read_table(table).err());
        }
        if damage.is_empty() {
            damage.extend(self.frame_times().err());
            damage.extend(self.signatures().err());
            damage.extend(self.cues().err());
            damage.extend(self.sound().err());
        }
        let mut done = 0;
        for unit in self.pack.units() {
            let frames = self.pack.frames_of(unit).len();
            let checked = self.read_chunk(unit).and_then(|chunk| {
                let parts = split_chunk(&chunk, frames).map(|parts| parts.len());
                parts.map_err(|source| self.format(source))
            });
            damage.extend(checked.err());
            done += u64::from(self.pack.entry(unit).bytes);
            progress(done, self.bytes());
        }
        damage
    }

    fn read_table(&self, table: &TableEntry) -> Result<Vec<u8>, PackFileError> {
        let what = format!("side table {}", table.name);
        let end = table.offset.checked_add(table.bytes);
        if end.is_none_or(|end| end > self.header.file_bytes) {
            return Err(self.format(PackError {
                field: what,
                found: format!("{}+{}", table.offset, table.bytes),
                expected: format!("within {}", counted(self.header.file_bytes, "byte")),
            }));
        }
        let bytes = self.read(table.offset, table.bytes, &|| what.clone())?;
        let checked = check_crc(&what, &bytes, table.crc32c);
        checked
            .map(|()| bytes)
            .map_err(|source| self.format(source))
    }

    fn read(
        &self,
        offset: u64,
        bytes: u64,
        what: &dyn Fn() -> String,
    ) -> Result<Vec<u8>, PackFileError> {
        // A panic while the lock was held cannot have left the file in a bad state.
        let mut file = self
            .file
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        read_at(&mut file, offset, bytes).map_err(|source| PackFileError::Io {
            path: self.path.clone(),
            what: format!("{} cannot be read", what()),
            source,
        })
    }

    fn format(&self, source: PackError) -> PackFileError {
        PackFileError::Format {
            path: self.path.clone(),
            source,
        }
    }
}

/// The file in which the pack of this name grows until it is whole.
#[must_use]
pub fn partial_path(pack: &Path) -> PathBuf {
    let mut name = pack.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    pack.with_file_name(name)
}

fn read_at(file: &mut File, offset: u64, bytes: u64) -> std::io::Result<Vec<u8>> {
    file.seek(SeekFrom::Start(offset))?;
    let mut buffer = Vec::new();
    file.take(bytes).read_to_end(&mut buffer)?;
    if buffer.len() as u64 == bytes {
        Ok(buffer)
    } else {
        Err(ErrorKind::UnexpectedEof.into())
    }
}
