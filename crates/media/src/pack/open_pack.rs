//! How are the parts of a pack's file read, whatever is in it?

use crate::plain_file::open_plain;
use foveal_core::pack::{HEADER_BYTES, Header, Index, PackError, TableEntry, UnitPlace, check_crc};
use foveal_core::session::decoder::{ByteSource, SourceError};
use foveal_core::units::counted;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What failed, why, and then what to do, which `what` gives after a semicolon.
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

impl PackFileError {
    /// What is wrong, without the place.
    pub(crate) fn reason(&self) -> String {
        match self {
            Self::Io { what, source, .. } => with_cause(what, source),
            Self::NoFile { what, .. } => (*what).to_owned(),
            Self::Format { source, .. } => source.to_string(),
        }
    }
}

/// What to do about bytes that are no pack of this version.
fn advice(path: &Path, error: &PackError) -> String {
    match error.field.as_str() {
        "magic" => {
            let (what, kind) = match is_scene(path) {
                true => ("3D scene", "scene"),
                false => ("video", "video"),
            };
            let path = path.display();
            format!(
                "; if it is a {what}, make a pack of it: `foveal prepare {kind} {path} --out PACK`"
            )
        }
        // The error itself says what to do.
        "version" | "description.kind" => String::new(),
        _ => "; if it was copied, copy it again, else prepare it again from its source".to_owned(),
    }
}

/// Whether a name ends as those of meshes, clouds and scene files do.
fn is_scene(path: &Path) -> bool {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    [
        "glb", "gltf", "vrm", "obj", "ply", "stl", "las", "laz", "toml",
    ]
    .iter()
    .any(|it| ending == *it)
}

/// An open file that begins with the header of a pack and is as long as that says.
#[derive(Debug)]
pub(crate) struct OpenPack {
    path: PathBuf,
    file: File,
    header: Header,
}

impl OpenPack {
    /// Opens a pack and reads its header and its description, whose checksum is not checked yet.
    pub(crate) fn open(path: &Path) -> Result<(Self, Vec<u8>), PackFileError> {
        let io = |what: &str, source| PackFileError::Io {
            path: path.to_owned(),
            what: what.to_owned(),
            source,
        };
        let format = |source| PackFileError::Format {
            path: path.to_owned(),
            source,
        };
        let (file, found) = open_plain(path).map_err(|error| {
            let what = match error.kind() {
                ErrorKind::IsADirectory => "is a folder",
                ErrorKind::Other => "is not a plain file",
                _ => return io("cannot be opened", error),
            };
            let path = path.to_owned();
            PackFileError::NoFile { path, what }
        })?;
        let mut head = Vec::new();
        let mut first = (&file).take(HEADER_BYTES as u64);
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
        let description = u64::from(header.description_bytes);
        let description = read_at(&file, HEADER_BYTES as u64, description)
            .map_err(|e| io("description cannot be read", e))?;
        let open = Self {
            path: path.to_owned(),
            file,
            header,
        };
        Ok((open, description))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    /// Reads all pages of an index, page by page.
    pub(crate) fn read_index(&self, index: &Index) -> Result<(), PackFileError> {
        let read = |place: Range<u64>| {
            let bytes = place.end - place.start;
            self.read(place.start, bytes, &|| "index".to_owned())
        };
        index.read_all(read, |source| self.format(source))
    }

    /// A side table, its checksum checked.
    pub(crate) fn read_table(&self, table: &TableEntry) -> Result<Vec<u8>, PackFileError> {
        let what = format!("side table {}", table.name);
        let range = table.range(self.header.file_bytes);
        range.map_err(|source| self.format(source))?;
        let bytes = self.read(table.offset, table.bytes, &|| what.clone())?;
        let checked = check_crc(&what, &bytes, table.crc32c);
        checked
            .map(|()| bytes)
            .map_err(|source| self.format(source))
    }

    /// The chunk of a unit, which errors call `what`, its checksum checked.
    pub(crate) fn read_chunk(
        &self,
        place: UnitPlace,
        what: &str,
    ) -> Result<Vec<u8>, PackFileError> {
        let wrong = |source| self.format(source);
        let entry = place.known(what).map_err(wrong)?;
        let chunk = self.read(entry.offset, u64::from(entry.bytes), &|| what.to_owned())?;
        entry.check(what, &chunk).map_err(wrong)?;
        Ok(chunk)
    }

    /// A part of the file, which errors call by what `what` says.
    pub(crate) fn read(
        &self,
        offset: u64,
        bytes: u64,
        what: &dyn Fn() -> String,
    ) -> Result<Vec<u8>, PackFileError> {
        read_at(&self.file, offset, bytes).map_err(|source| PackFileError::Io {
            path: self.path.clone(),
            what: format!("{} cannot be read", what()),
            source,
        })
    }

    pub(crate) fn format(&self, source: PackError) -> PackFileError {
        PackFileError::Format {
            path: self.path.clone(),
            source,
        }
    }
}

/// Bytes that memory is had for before they are read: of a chunk more than most.
const MOST_RESERVED: u64 = 1 << 20;

/// A part of a file, which threads read at once, each at a place of its own.
fn read_at(file: &File, offset: u64, bytes: u64) -> std::io::Result<Vec<u8>> {
    // What is not there takes little memory, however long it says that it is.
    let mut buffer = Vec::with_capacity(bytes.min(MOST_RESERVED) as usize);
    let mut part = PartOfFile { file, at: offset };
    (&mut part).take(bytes).read_to_end(&mut buffer)?;
    if buffer.len() as u64 == bytes {
        Ok(buffer)
    } else {
        Err(ErrorKind::UnexpectedEof.into())
    }
}

/// Reads on from a place without moving the file's own cursor.
struct PartOfFile<'a> {
    file: &'a File,
    at: u64,
}

impl Read for PartOfFile<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        #[cfg(unix)]
        let read = std::os::unix::fs::FileExt::read_at(self.file, buffer, self.at)?;
        #[cfg(windows)]
        let read = std::os::windows::fs::FileExt::seek_read(self.file, buffer, self.at)?;
        self.at += read as u64;
        Ok(read)
    }
}

impl ByteSource for OpenPack {
    fn read(&self, range: Range<u64>, what: &dyn Fn() -> String) -> Result<Vec<u8>, SourceError> {
        let read = Self::read(self, range.start, range.end - range.start, what);
        read.map_err(|error| SourceError(Box::new(error)))
    }

    fn damaged(&self, error: PackError) -> SourceError {
        SourceError(Box::new(self.format(error)))
    }
}
