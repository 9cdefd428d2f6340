//! Which parts of a video's pack have been loaded?

use super::bytes::calibration_table::CALIBRATION;
use super::bytes::chunk::split_chunk;
use super::bytes::cue_table::{CUES, CueTable};
use super::bytes::frame_times::{FRAME_TIMES, nominal_times, parse_frame_times};
use super::bytes::pack::VideoPack;
use super::bytes::signatures::{SIGNATURES, Signatures};
use super::bytes::sound::{SOUND, SoundTable};
use super::calibration::{Calibration, Scale, density_of};
use super::demand::VideoDemand;
use super::grid::places::SharedPlaces;
use super::grid::tile_grid::{Tile, TileGrid};
use super::units::VideoUnits;
use crate::content::demand::{Content, Demand};
use crate::content::head::ContentHead;
use crate::content::policy::{HasTables, PolicyConfig};
use crate::content::unit::Unit;
use crate::pack::unit::UnitId;
use crate::pack::{PackError, TableEntry, UnitPlace, check_crc};
use crate::perception::measures::contrast::Signature;
use crate::perception::measures::cues::Cues;
use crate::units::Seconds;
use crate::view::eye_view::EyeView;
use crate::view::surface::Screen;
use crate::view::timeline::Timeline;
use core::ops::Range;
use glam::DVec3;
use std::collections::HashSet;
use std::sync::{Arc, OnceLock, PoisonError, RwLock};

/// A video: description and index of its pack with the side tables, as far as they have been
/// loaded. One serves all viewers; what comes is added behind a shared reference.
#[derive(Debug)]
pub struct Video {
    name: String,
    pack: Arc<VideoPack>,
    grid: TileGrid,
    times: OnceLock<Vec<i64>>,
    signatures: OnceLock<Signatures>,
    cues: OnceLock<CueTable>,
    sound: OnceLock<SoundTable>,
    calibration: OnceLock<Calibration>,
    lost: RwLock<Lost>,
    places: SharedPlaces,
}

/// What cannot be loaded, because it is damaged.
#[derive(Debug, Default)]
struct Lost {
    pages: HashSet<u32>,
    tables: HashSet<String>,
}

impl Video {
    /// The video of this pack, called `name` in logs, flat content filling `screen`; no side table
    /// has been loaded.
    #[must_use]
    pub fn new(name: &str, pack: Arc<VideoPack>, screen: Screen) -> Self {
        Self {
            name: name.to_owned(),
            grid: pack.description().grid(screen),
            pack,
            times: OnceLock::new(),
            signatures: OnceLock::new(),
            cues: OnceLock::new(),
            sound: OnceLock::new(),
            calibration: OnceLock::new(),
            lost: RwLock::default(),
            places: SharedPlaces::default(),
        }
    }

    /// Description and index.
    #[must_use]
    pub fn pack(&self) -> &Arc<VideoPack> {
        &self.pack
    }

    /// The tiles, with flat content filling the screen.
    #[must_use]
    pub fn grid(&self) -> &TileGrid {
        &self.grid
    }

    /// When each frame begins, in nanoseconds after the first: by the table once it has been
    /// loaded, until then by the nominal rate.
    #[must_use]
    pub fn frame_times(&self) -> Vec<i64> {
        let nominal = || nominal_times(self.pack.description());
        self.times.get().cloned().unwrap_or_else(nominal)
    }

    /// The sound, once its table has been loaded.
    #[must_use]
    pub fn sound(&self) -> Option<&SoundTable> {
        self.sound.get()
    }

    /// What the judge found of it, once its table has been loaded.
    #[must_use]
    pub fn calibration(&self) -> Option<&Calibration> {
        self.calibration.get()
    }

    /// The entry of a side table; `None` where the pack has none of that name.
    #[must_use]
    pub fn table(&self, name: &str) -> Option<&TableEntry> {
        let mut tables = self.pack.description().tables.iter();
        tables.find(|table| table.name == name)
    }

    /// The entry of a side table that has not been loaded and still may; `None` where the pack has
    /// none of that name.
    #[must_use]
    pub fn table_to_come(&self, name: &str) -> Option<&TableEntry> {
        let is_there = match name {
            FRAME_TIMES => self.times.get().is_some(),
            SIGNATURES => self.signatures.get().is_some(),
            CUES => self.cues.get().is_some(),
            SOUND => self.sound.get().is_some(),
            CALIBRATION => self.calibration.get().is_some(),
            _ => false,
        };
        let is_settled = is_there || self.has_lost(|lost| lost.tables.contains(name));
        self.table(name).filter(|_| !is_settled)
    }

    /// Names of the side tables by which a policy chooses and says which score to expect.
    #[must_use]
    pub fn tables_of(config: &PolicyConfig) -> &'static [&'static str] {
        match config.policy.has_target() {
            true => &[SIGNATURES, CALIBRATION],
            false => &[],
        }
    }

    /// Takes the bytes of a side table; refuses what its checksum or its reader does. A table of
    /// another name is passed over.
    pub fn add_table(&self, name: &str, bytes: Vec<u8>) -> Result<(), PackError> {
        let Some(table) = self.table(name) else {
            return Ok(());
        };
        check_crc(&format!("side table {name}"), &bytes, table.crc32c)?;
        let (pack, version) = (&*self.pack, table.version);
        // A table that was loaded already says the same.
        match name {
            FRAME_TIMES => {
                let frames = pack.description().frames;
                let _ = self.times.set(parse_frame_times(frames, version, &bytes)?);
            }
            SIGNATURES => {
                let table = Signatures::parse(pack, version, bytes)?;
                let _ = self.signatures.set(table);
            }
            CUES => {
                let _ = self.cues.set(CueTable::parse(pack, version, bytes)?);
            }
            SOUND => {
                let _ = self.sound.set(SoundTable::parse(version, &bytes)?);
            }
            CALIBRATION => {
                let _ = self.calibration.set(Calibration::parse(version, &bytes)?);
            }
            _ => {}
        }
        Ok(())
    }

    /// A side table cannot be had.
    pub fn fail_table(&self, name: &str) {
        let mut lost = self.lost.write().unwrap_or_else(PoisonError::into_inner);
        lost.tables.insert(name.to_owned());
    }

    /// A page of the index cannot be had: nor can the units that it covers.
    pub fn fail_page(&self, page: u32) {
        let mut lost = self.lost.write().unwrap_or_else(PoisonError::into_inner);
        lost.pages.insert(page);
    }

    fn has_lost<T>(&self, what: impl FnOnce(&Lost) -> T) -> T {
        what(&self.lost.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Whether a page of the index has been loaded, or never will be.
    #[must_use]
    pub fn is_settled(&self, page: u32) -> bool {
        self.pack.index().has_page(page) || self.has_lost(|lost| lost.pages.contains(&page))
    }

    /// The index pages that cover a level in the group of a frame.
    #[must_use]
    pub fn pages_of(&self, level: u8, frame: u32) -> Range<u32> {
        let (pack, grid) = (&self.pack, &self.grid);
        let last = grid.tiles_in_level(level) - 1;
        let [first, last] = [0, last].map(|rank| {
            let unit = pack.unit(grid.tile_at(level, rank), frame);
            pack.index().numbers().page_of(unit)
        });
        first..last + 1
    }

    /// Whether everything has been loaded by which a budget is spent on a frame.
    #[must_use]
    pub fn can_spend(&self, frame: u32) -> bool {
        let frames = [Some(frame), self.next_group(frame)];
        let has_pages = |frame: u32| {
            let levels = 0..self.grid.levels;
            let mut pages = levels.flat_map(|level| self.pages_of(level, frame));
            pages.all(|page| self.is_settled(page))
        };
        self.has_signatures() && frames.into_iter().flatten().all(has_pages)
    }

    /// The access units of a chunk, its checksum checked.
    pub fn access_units<'a>(
        &self,
        unit: UnitId,
        chunk: &'a [u8],
    ) -> Result<Vec<&'a [u8]>, PackError> {
        let Tile { level, face, x, y } = self.pack.tile_of(unit);
        let what = format!("chunk of level {level}, face {face}, column {x}, row {y}");
        self.place(unit).known(&what)?.check(&what, chunk)?;
        split_chunk(chunk, self.pack.frames_of(unit).len())
    }
}

impl Content for Video {
    fn name(&self) -> &str {
        &self.name
    }

    fn timeline(&self) -> Timeline {
        let period = Seconds(self.pack.description().last_frame_s());
        Timeline::new(&self.frame_times(), period)
    }

    fn unit(&self, unit: UnitId) -> Unit {
        let tile = self.pack.tile_of(unit);
        let [width, height] = self.grid.tile_size(tile);
        let samples = u64::from(width) * u64::from(height);
        let chroma = u64::from(width.div_ceil(2)) * u64::from(height.div_ceil(2));
        let entry = self.pack.index().known_entry(unit);
        Unit {
            level: tile.level,
            bytes: entry.map(|entry| entry.bytes),
            samples,
            gpu_bytes: samples + 2 * chroma,
            frames: self.pack.frames_of(unit),
        }
    }

    fn place(&self, unit: UnitId) -> UnitPlace {
        match self.pack.index().place(unit) {
            UnitPlace::OnPage { page, .. } if self.has_lost(|lost| lost.pages.contains(&page)) => {
                UnitPlace::Lost
            }
            place => place,
        }
    }

    fn chunk_name(&self, unit: UnitId) -> String {
        self.pack.chunk_name(unit)
    }

    fn base(&self, frame: u32) -> Vec<UnitId> {
        let tiles = self.grid.tiles_of(self.grid.coarsest());
        tiles.map(|tile| self.pack.unit(tile, frame)).collect()
    }

    fn coarsest(&self) -> u8 {
        self.grid.coarsest()
    }

    fn at_frame(&self, unit: UnitId, frame: u32) -> UnitId {
        self.pack.unit(self.pack.tile_of(unit), frame)
    }

    fn direction(&self, unit: UnitId, _eye: DVec3) -> DVec3 {
        self.grid.centre(self.pack.tile_of(unit))
    }

    fn finest_samples(&self) -> u64 {
        self.grid.surface.pixels()
    }

    fn has(&self) -> HasTables {
        HasTables {
            signatures: self.table(SIGNATURES).is_some(),
            cues: self.table(CUES).is_some(),
        }
    }

    fn is_ready(&self, config: &PolicyConfig, frame: u32) -> bool {
        match config.policy.spends_a_budget() {
            true => self.can_spend(frame),
            false => !config.needs_signatures() || self.has_signatures(),
        }
    }

    fn may_become_ready(&self) -> bool {
        self.has_signatures() || self.table_to_come(SIGNATURES).is_some()
    }

    fn demand(self: Arc<Self>, head: &ContentHead, config: &PolicyConfig) -> Box<dyn Demand> {
        let grid = head.video().copied().unwrap_or(self.grid);
        Box::new(VideoDemand::new(self, grid, config.clone()))
    }

    fn head(&self) -> ContentHead {
        ContentHead::of_video(self.grid)
    }
}

impl VideoUnits for Video {
    fn unit(&self, tile: Tile, frame: u32) -> UnitId {
        self.pack.unit(tile, frame)
    }

    fn next_group(&self, frame: u32) -> Option<u32> {
        let about = self.pack.description();
        let length = about.groups.first()?;
        let next = (frame / length + 1) * length;
        (next < about.frames).then_some(next)
    }

    fn bytes(&self, unit: UnitId) -> u32 {
        let entry = self.pack.index().known_entry(unit);
        entry.map_or(u32::MAX, |entry| entry.bytes)
    }

    fn has_signatures(&self) -> bool {
        self.signatures.get().is_some()
    }

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        self.signatures.get()?.of(unit)
    }

    fn tells_of_noise(&self) -> bool {
        self.signatures.get().is_some_and(Signatures::tell_of_noise)
    }

    fn cues(&self, unit: UnitId) -> Option<Cues> {
        self.cues.get()?.of(unit)
    }

    fn places(&self, grid: &TileGrid) -> Option<&SharedPlaces> {
        (*grid == self.grid).then_some(&self.places)
    }

    fn scale(&self, view: Option<&EyeView>) -> Scale {
        let ppd = view.map(|view| density_of(&self.grid.surface, view));
        let scale = |calibration: &Calibration| calibration.at(ppd);
        self.calibration.get().map_or_else(Scale::usual, scale)
    }
}
