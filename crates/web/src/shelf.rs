//! What is there of a pack so far, beside its chunks?

use foveal_core::content::video::bytes::chunk::split_chunk;
use foveal_core::content::video::bytes::cue_table::{CUES, CueTable};
use foveal_core::content::video::bytes::frame_times::{
    FRAME_TIMES, nominal_times, parse_frame_times,
};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::content::video::bytes::signatures::{SIGNATURES, Signatures};
use foveal_core::content::video::bytes::sound::{SOUND, SoundTable};
use foveal_core::content::video::grid::tile_grid::{Tile, TileGrid};
use foveal_core::content::video::units::Content;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{HEADER_BYTES, Header, PackError, check_crc};
use foveal_core::perception::measures::contrast::Signature;
use foveal_core::perception::measures::cues::Cues;
use foveal_core::session::picker::HasTables;
use foveal_core::session::timeline::Timeline;
use foveal_core::units::{Seconds, counted};
use foveal_core::view::surface::Screen;
use std::collections::HashSet;
use std::ops::Range;

/// A pack that comes in pieces.
pub(crate) struct Shelf {
    pub(crate) header: Header,
    pub(crate) pack: VideoPack,
    pub(crate) grid: TileGrid,
    /// Pages of the index that cannot be had.
    pub(crate) damaged_pages: HashSet<u32>,
    /// Side tables that cannot be had.
    pub(crate) damaged_tables: HashSet<String>,
    times: Option<Vec<i64>>,
    signatures: Option<Signatures>,
    cues: Option<CueTable>,
    pub(crate) sound: Option<SoundTable>,
}

impl Shelf {
    /// A pack of which header and description are there, flat content filling `screen`.
    pub(crate) fn new(head: &[u8], screen: Screen) -> Result<Self, PackError> {
        let header = Header::parse(head)?;
        let end = HEADER_BYTES + header.description_bytes as usize;
        let Some(description) = head.get(HEADER_BYTES..end) else {
            return Err(PackError {
                field: "description".to_owned(),
                found: format!("{} of the file", counted(head.len(), "byte")),
                expected: format!("{end}"),
            });
        };
        let pack = VideoPack::begin(&header, description)?;
        Ok(Self {
            header,
            grid: pack.description().grid(screen),
            pack,
            damaged_pages: HashSet::new(),
            damaged_tables: HashSet::new(),
            times: None,
            signatures: None,
            cues: None,
            sound: None,
        })
    }

    /// The frames in time: by the table once it is there, until then by the nominal rate.
    pub(crate) fn timeline(&self) -> Timeline {
        let about = self.pack.description();
        let period = Seconds(1.0 / about.fps());
        match &self.times {
            Some(times) => Timeline::new(times, period),
            None => Timeline::new(&nominal_times(about), period),
        }
    }

    /// Where a side table lies in the file; `None` where the pack has none of that name.
    pub(crate) fn table_place(&self, name: &str) -> Option<Range<u64>> {
        let tables = &self.pack.description().tables;
        let table = tables.iter().find(|table| table.name == name)?;
        let end = table.offset.checked_add(table.bytes)?;
        (end <= self.header.file_bytes).then_some(table.offset..end)
    }

    /// Takes the bytes of a side table; refuses what its checksum or its reader does.
    pub(crate) fn add_table(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), PackError> {
        let about = self.pack.description();
        let Some(table) = about.tables.iter().find(|table| table.name == name) else {
            return Ok(());
        };
        check_crc(&format!("side table {name}"), &bytes, table.crc32c)?;
        let version = table.version;
        match name {
            FRAME_TIMES => {
                self.times = Some(parse_frame_times(about.frames, version, &bytes)?);
            }
            SIGNATURES => self.signatures = Some(Signatures::parse(&self.pack, version, bytes)?),
            CUES => self.cues = Some(CueTable::parse(&self.pack, version, bytes)?),
            SOUND => self.sound = Some(SoundTable::parse(version, &bytes)?),
            _ => {}
        }
        Ok(())
    }

    /// The tables that the pack has, read or not.
    pub(crate) fn has(&self) -> HasTables {
        HasTables {
            signatures: self.table_place(SIGNATURES).is_some(),
            cues: self.table_place(CUES).is_some(),
        }
    }

    /// Whether it is known what each unit adds.
    pub(crate) fn has_signatures(&self) -> bool {
        self.signatures.is_some()
    }

    /// Whether that is known, or may be yet.
    pub(crate) fn may_get_signatures(&self) -> bool {
        self.has_signatures() || self.has().signatures && !self.damaged_tables.contains(SIGNATURES)
    }

    /// Lengths of the access units of a chunk, its checksum checked.
    pub(crate) fn lengths(&self, unit: UnitId, chunk: &[u8]) -> Result<Vec<u32>, PackError> {
        let Some(entry) = self.pack.index().known_entry(unit) else {
            return Ok(Vec::new());
        };
        let Tile { level, face, x, y } = self.pack.tile_of(unit);
        let what = format!("chunk of level {level}, face {face}, column {x}, row {y}");
        check_crc(&what, chunk, entry.crc32c)?;
        let units = split_chunk(chunk, self.pack.frames_of(unit).len())?;
        Ok(units.iter().map(|unit| unit.len() as u32).collect())
    }

    /// The index pages that tell of a level in the group of a frame.
    pub(crate) fn pages_of(&self, level: u8, frame: u32) -> Range<u32> {
        let first = self.pack.unit(self.grid.tile_at(level, 0), frame);
        let last = self.grid.tiles_in_level(level) - 1;
        let last = self.pack.unit(self.grid.tile_at(level, last), frame);
        self.pack.index().numbers().page_of(first)..self.pack.index().numbers().page_of(last) + 1
    }

    /// Whether nothing is ever known of where a unit's chunk lies.
    pub(crate) fn is_lost(&self, unit: UnitId) -> bool {
        self.damaged_pages
            .contains(&self.pack.index().numbers().page_of(unit))
    }

    /// Whether everything is there by which a budget is spent on a frame.
    pub(crate) fn can_spend(&self, frame: u32) -> bool {
        let frames = [Some(frame), self.next_group(frame)];
        let pages_there = |frame: u32| {
            let levels = 0..self.grid.levels;
            let mut pages = levels.flat_map(|level| self.pages_of(level, frame));
            pages.all(|page| self.pack.index().has_page(page) || self.damaged_pages.contains(&page))
        };
        self.has_signatures() && frames.into_iter().flatten().all(pages_there)
    }
}

impl Content for Shelf {
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

    fn signature(&self, unit: UnitId) -> Option<Signature> {
        self.signatures.as_ref()?.of(unit)
    }

    fn cues(&self, unit: UnitId) -> Option<Cues> {
        self.cues.as_ref()?.of(unit)
    }
}
