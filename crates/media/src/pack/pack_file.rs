//! How is a pack read from a file?

use crate::error::MediaError;
use crate::pack::damage::Damage;
use crate::pack::open_pack::OpenPack;
pub use crate::pack::open_pack::PackFileError;
use crate::tiles::decode::GroupDecoder;
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::calibration_table::CALIBRATION;
use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::bytes::cue_table::{CUES, CueTable};
use foveal_core::content::video::bytes::frame_times::{
    FRAME_TIMES, nominal_times, parse_frame_times,
};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::content::video::bytes::signatures::{SIGNATURES, Signatures};
use foveal_core::content::video::bytes::sound::{SOUND, SoundTable};
use foveal_core::content::video::calibration::Calibration;
use foveal_core::pack::PackError;
use foveal_core::pack::unit::UnitId;
use foveal_core::session::decoder::ByteSource;
use foveal_core::units::one_line;
use foveal_core::view::surface::Screen;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Pixels of the coarsest level that are decoded at most to check it, unless two pictures have
/// more: a fraction of a second of work.
const MOST_DECODED: u64 = 64 << 20;

/// An open pack: description and index in memory, chunks read when they are asked for.
#[derive(Debug)]
pub struct PackFile {
    open: Arc<OpenPack>,
    pack: Arc<VideoPack>,
}

impl PackFile {
    /// Opens a pack of video and reads its header, description and index.
    pub fn open(path: &Path) -> Result<Self, PackFileError> {
        let (open, description) = OpenPack::open(path)?;
        Self::read(open, &description)
    }

    pub(super) fn read(open: OpenPack, description: &[u8]) -> Result<Self, PackFileError> {
        let pack = VideoPack::begin(open.header(), description);
        let pack = pack.map_err(|source| open.format(source))?;
        open.read_index(pack.index())?;
        Ok(Self {
            pack: Arc::new(pack),
            open: Arc::new(open),
        })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.open.path()
    }

    /// The source of its bytes.
    #[must_use]
    pub fn source(&self) -> Arc<dyn ByteSource> {
        Arc::clone(&self.open) as Arc<dyn ByteSource>
    }

    /// Its description and index.
    #[must_use]
    pub fn pack(&self) -> &Arc<VideoPack> {
        &self.pack
    }

    /// The video with the side tables by which units are chosen, flat content filling `screen`.
    ///
    /// # Errors
    /// A table is damaged.
    pub fn video(&self, screen: Screen) -> Result<Arc<Video>, PackFileError> {
        let name = self
            .path()
            .file_name()
            .unwrap_or_default()
            .to_string_lossy();
        let video = Video::new(&name, Arc::clone(&self.pack), screen);
        for name in [FRAME_TIMES, SIGNATURES, CUES] {
            if let Some(table) = video.table(name) {
                let added = video.add_table(name, self.open.read_table(table)?);
                added.map_err(|source| self.open.format(source))?;
            }
        }
        // A player does without: what it chooses for is then expected by constants.
        if let (Some(table), Ok(Some(_))) = (video.table(CALIBRATION), self.calibration()) {
            let added = video.add_table(CALIBRATION, self.open.read_table(table)?);
            added.map_err(|source| self.open.format(source))?;
        }
        Ok(Arc::new(video))
    }

    /// Bytes of the file.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.open.header().file_bytes
    }

    /// The chunk of a unit, its checksum checked.
    pub fn read_chunk(&self, unit: UnitId) -> Result<Vec<u8>, PackFileError> {
        let what = self.pack.chunk_name(unit);
        self.open.read_chunk(self.pack.index().place(unit), &what)
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

    /// What the judge found of the content, from the side table `calibration`; `None` where the
    /// pack has none.
    pub fn calibration(&self) -> Result<Option<Calibration>, PackFileError> {
        self.parse_table(CALIBRATION, |version, bytes| {
            Calibration::parse(version, &bytes)
        })
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
        let rows = self.open.read_table(table)?;
        let parsed = parse(table.version, rows);
        parsed.map(Some).map_err(|source| self.open.format(source))
    }

    /// Reads every byte once and checks it: `progress` receives how many bytes are done of how
    /// many. Returns what is damaged, nothing if all is well; of chunks or tables that overlap or
    /// leave gaps that alone.
    pub fn verify(&self, mut progress: impl FnMut(u64, u64)) -> Damage {
        if let Err(source) = self.pack.check_coverage(self.open.header()) {
            return Damage::tangled(self.open.format(source));
        }
        let mut damage = Damage::default();
        for table in &self.pack.description().tables {
            damage.add(self.open.read_table(table));
        }
        if damage.is_empty() {
            damage.add(self.frame_times());
            damage.add(self.signatures());
            damage.add(self.cues());
            damage.add(self.sound());
            damage.add(self.calibration());
        }
        let mut done = 0;
        for unit in self.pack.units() {
            let frames = self.pack.frames_of(unit).len();
            let checked = self.read_chunk(unit).and_then(|chunk| {
                let parts = split_chunk(&chunk, frames);
                let parts = parts.map_err(|source| self.open.format(source))?;
                match self.is_decoded(unit) {
                    true => self.decode_unit(unit, &parts),
                    false => Ok(()),
                }
            });
            damage.add(checked);
            done += u64::from(self.pack.entry(unit).bytes);
            progress(done, self.bytes());
        }
        damage
    }

    /// Whether the pictures of a chunk are decoded where it is checked: of the coarsest level,
    /// without which nothing is shown, the first group, the last and as many evenly between as a
    /// limit of pixels allows.
    fn is_decoded(&self, unit: UnitId) -> bool {
        let (about, grid) = (self.pack.description(), self.pack.grid());
        let tile = self.pack.tile_of(unit);
        if tile.level != grid.coarsest() {
            return false;
        }
        let length = about.groups[usize::from(tile.level)].max(1);
        let groups = u64::from(about.frames.div_ceil(length));
        let tiles = u64::from(grid.tiles_in_level(tile.level));
        let [w, h] = grid.tile_size(tile).map(u64::from);
        let group_pixels = tiles * w * h * u64::from(length.min(about.frames));
        let most = (MOST_DECODED / group_pixels.max(1)).clamp(2, groups.max(2));
        let group = u64::from(self.pack.frames_of(unit).start / length);
        // The group is the first of its share of all, or the last one.
        group + 1 == groups || group * most % groups < most
    }

    /// Decodes the pictures of a chunk.
    fn decode_unit(&self, unit: UnitId, parts: &[&[u8]]) -> Result<(), PackFileError> {
        let frames = self.pack.frames_of(unit);
        let tile = self.pack.tile_of(unit);
        let grid = self.pack.grid();
        let size = grid.tile_size(tile);
        // Of large pictures a group alone may be beyond the limit.
        let [w, h] = size.map(u64::from);
        let level_pixels = u64::from(grid.tiles_in_level(tile.level)) * w * h;
        let most = (MOST_DECODED / 2 / level_pixels.max(1)).max(1) as usize;
        let decode = || {
            let mut decoder = GroupDecoder::new(self.pack.description().codec, size)?;
            for (number, part) in frames.clone().zip(parts).take(most) {
                decoder.decode(part, i64::from(number))?;
            }
            Ok::<_, MediaError>(())
        };
        decode().map_err(|error| {
            self.open.format(PackError {
                field: format!(
                    "chunk of level {}, frames from {}",
                    tile.level, frames.start
                ),
                found: one_line(&error.to_string()),
                expected: "pictures that decode".to_owned(),
            })
        })
    }
}

/// The file in which the pack of this name grows until it is whole.
#[must_use]
pub fn partial_path(pack: &Path) -> PathBuf {
    let mut name = pack.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    pack.with_file_name(name)
}
