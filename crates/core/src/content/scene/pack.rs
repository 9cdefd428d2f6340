//! Which units are in the pack of a scene, and where are their bytes?

use super::description::{KIND, OBJECTS, SceneDescription};
use super::kind::UnitKind;
use super::object_table::{
    NAMES, NAMES_VERSION, OBJECTS_VERSION, read_objects, write_names, write_objects,
};
use super::unit_table::{OF_ALL, UNITS, UNITS_VERSION, UnitRow, read_units, write_units};
use crate::content::images::shape::TextureShape;
use crate::content::payload::Payload;
use crate::content::points::cut::OCTANTS;
use crate::content::scene::part_ref::PartRef;
use crate::pack::paged_table::PageDirectory;
use crate::pack::unit::UnitId;
use crate::pack::{
    ChunkName, Entry, HEADER_BYTES, Header, Index, PackBuilder, PackError, PackHead, SideTable,
    TableEntry, UnitNumbers, check_crc,
};
use serde::Deserialize;
use std::collections::HashMap;

/// Most units, each counted in every place where its object stands: a reader keeps a sphere of
/// each.
const MOST_STANDS: u64 = 1 << 24;

/// Most pages of textures, of which a reader keeps eight bytes each, and more for each that has a
/// unit.
const MOST_PAGES_FREE: u64 = 1 << 20;
const MOST_PAGES_OF_UNIT: u64 = 16;

/// Bytes of a description beyond which its objects go into a side table.
const LONG: usize = 1 << 15;

/// Description, index and table of units of a scene pack: everything but the chunks.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePack {
    description: SceneDescription,
    index: Index,
    directory: PageDirectory,
    rows: Vec<UnitRow>,
}

/// What distinguishes kinds of packs; a video's has none.
#[derive(Deserialize)]
struct Kind {
    #[serde(default)]
    kind: Option<String>,
}

/// Whether a description is of a scene.
#[must_use]
pub fn is_scene(description: &[u8]) -> bool {
    let kind = serde_json::from_slice::<Kind>(description);
    kind.is_ok_and(|it| it.kind.as_deref() == Some(KIND))
}

fn numbers_of(description: &SceneDescription) -> Result<UnitNumbers, PackError> {
    let units: Vec<u64> = description.units.iter().map(|it| u64::from(*it)).collect();
    UnitNumbers::in_pages_of(description.page, &units)
}

impl ScenePack {
    /// Reads the description of a pack whose header is `header`: with it the index can be read, and
    /// the table of units; where it has a table of objects, that is to be read first, for
    /// [`SceneDescription::with_objects`].
    ///
    /// # Errors
    /// It is damaged, of another kind, or needs more than this program understands.
    pub fn describe(header: &Header, description: &[u8]) -> Result<SceneDescription, PackError> {
        check_crc("description", description, header.description_crc)?;
        let description = SceneDescription::parse(description)?;
        let expected = numbers_of(&description)?.index_bytes();
        if header.index_bytes != expected {
            return Err(PackError::new("index_bytes", header.index_bytes, expected));
        }
        description.units_table()?;
        description.objects_table()?;
        Ok(description)
    }

    /// A pack by its header, description, index and table of units.
    ///
    /// # Errors
    /// One of them is damaged, or they do not fit to each other.
    pub fn new(
        header: &Header,
        description: SceneDescription,
        index: &[u8],
        table: &[u8],
    ) -> Result<Self, PackError> {
        let of_pages = Self::index_of(header, &description)?;
        of_pages.add_all(index)?;
        Self::of_index(description, of_pages, table)
    }

    /// The index of the pack of a description whose header is `header`, without any of its pages.
    ///
    /// # Errors
    /// The header gives another length than the description's units take.
    pub fn index_of(header: &Header, description: &SceneDescription) -> Result<Index, PackError> {
        Index::new(header, numbers_of(description)?)
    }

    /// A pack by its description, an index with all of its pages, and its table of units.
    ///
    /// # Errors
    /// One of them is damaged, or they do not fit to each other.
    pub fn of_index(
        description: SceneDescription,
        index: Index,
        table: &[u8],
    ) -> Result<Self, PackError> {
        let entry = description.units_table()?;
        check_crc(&format!("side table {UNITS}"), table, entry.crc32c)?;
        let numbers = numbers_of(&description)?;
        let directory = PageDirectory::parse(table, numbers.units(), table.len() as u64)?;
        let mut rows = Vec::new();
        for page in 0..directory.len() {
            let place = directory.place(page);
            let bytes = &table[place.start as usize..place.end as usize];
            rows.extend(read_units(&directory, page, bytes)?);
        }
        let pack = Self {
            description,
            index,
            directory,
            rows,
        };
        pack.check_rows()?;
        Ok(pack)
    }

    fn check_rows(&self) -> Result<(), PackError> {
        let objects = self.description.objects.len();
        let mut stands = 0;
        for (unit, row) in (0..).map(UnitId).zip(&self.rows) {
            let wrong = |what: &str, found: String, expected: String| {
                let field = format!("table {UNITS}, unit {}, {what}", unit.0);
                Err(PackError::new(&field, found, expected))
            };
            let object = self.description.objects.get(usize::from(row.object));
            stands += match (object, row.object, row.kind) {
                (Some(object), ..) => object.placements.len() as u64,
                (None, OF_ALL, kind) if !kind.facts().is_shape => 1,
                _ => {
                    let expected = format!("fewer than {objects}");
                    return wrong("object", row.object.to_string(), expected);
                }
            };
            if stands > MOST_STANDS {
                let expected = format!("at most {MOST_STANDS}");
                return wrong("units in all places", stands.to_string(), expected);
            }
            let is_root = self.level_of(unit) == self.coarsest();
            if is_root != row.needs.is_empty() {
                let found = format!("{} at level {}", row.needs.len(), self.level_of(unit));
                return wrong("needs", found, "none of a root, some of others".to_owned());
            }
            let of_other = |need: &&UnitId| {
                let need = &self.rows[need.0 as usize];
                (need.object, need.kind) != (row.object, row.kind)
            };
            if let Some(need) = row.needs.iter().find(of_other) {
                let found = format!("unit {} of another object or kind", need.0);
                return wrong("needs", found, "units of its object and kind".to_owned());
            }
            self.check_kind(row).map_err(|source| PackError {
                field: format!("table {UNITS}, unit {}, {}", unit.0, source.field),
                ..source
            })?;
        }
        self.check_textures()?;
        self.check_points()
    }

    /// Whether there are units for the pages of all textures: a reader keeps a table of them.
    fn check_textures(&self) -> Result<(), PackError> {
        let pages = self.description.textures.iter().map(|texture| {
            let shape = TextureShape { size: texture.size };
            let of_level = (0..=shape.root()).map(|level| shape.pages(level));
            of_level
                .map(|it| it.map(u64::from).iter().product::<u64>())
                .sum::<u64>()
        });
        let pages: u64 = pages.sum();
        let units = self
            .rows
            .iter()
            .filter(|it| it.kind == UnitKind::Image)
            .count() as u64;
        // Those that no surface shows have none.
        let most = MOST_PAGES_FREE + MOST_PAGES_OF_UNIT * units;
        match pages <= most {
            true => Ok(()),
            false => Err(PackError::new(
                "pages of textures",
                pages,
                format!("at most {most}, for the {units} that have a unit"),
            )),
        }
    }

    /// Whether a unit is of the kind of its object, and one of points refines an octant.
    fn check_kind(&self, row: &UnitRow) -> Result<(), PackError> {
        let object = self.description.objects.get(usize::from(row.object));
        let is_points = row.kind == UnitKind::Points;
        if object.is_some_and(|it| it.shape.kind() != row.kind.facts().objects) {
            let found = format!("{:?}", row.kind);
            return Err(PackError::new("kind", found, "the kind of its object"));
        }
        let is_octant = |it: &&PartRef| usize::from(it.part) < OCTANTS && it.need == 0;
        let octants = row.replaces.iter().filter(is_octant).count();
        let one = usize::from(!row.needs.is_empty());
        if is_points && [row.needs.len(), row.replaces.len(), octants] != [one; 3] {
            let found = format!("{:?} of {:?}", row.replaces, row.needs);
            let expected = "an octant of one unit";
            return Err(PackError::new("replaces", found, expected));
        }
        Ok(())
    }

    /// Whether all points of each cloud are there.
    fn check_points(&self) -> Result<(), PackError> {
        let objects = &self.description.objects;
        let mut counts = vec![0_u64; objects.len()];
        let points = self.rows.iter().filter(|it| it.kind == UnitKind::Points);
        points.for_each(|it| counts[usize::from(it.object)] += u64::from(it.samples));
        for (object, count) in objects.iter().zip(counts) {
            if let Some(cloud) = object.shape.cloud().filter(|it| it.count != count) {
                let field = format!("table {UNITS}, points of {:?}", object.name);
                return Err(PackError::new(&field, count, cloud.count));
            }
        }
        Ok(())
    }

    /// What the pack says about its scene.
    #[must_use]
    pub fn description(&self) -> &SceneDescription {
        &self.description
    }

    /// Where the chunks of units lie.
    #[must_use]
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// The table's row of a unit.
    ///
    /// # Panics
    /// There must be such a unit.
    #[must_use]
    pub fn row(&self, unit: UnitId) -> &UnitRow {
        &self.rows[unit.0 as usize]
    }

    /// The table's rows of all units, in order.
    #[must_use]
    pub fn rows(&self) -> &[UnitRow] {
        &self.rows
    }

    /// The unit that refines each cluster that one does, by the cluster's unit and number there.
    #[must_use]
    pub fn refiners(&self) -> HashMap<(UnitId, u8), UnitId> {
        let units = (0..).map(UnitId).zip(&self.rows);
        let refiners = units.flat_map(|(unit, row)| {
            let cluster = |it: &PartRef| Some((*row.needs.get(usize::from(it.need))?, it.part));
            let clusters = row.replaces.iter().filter_map(cluster);
            clusters.map(move |cluster| (cluster, unit))
        });
        refiners.collect()
    }

    /// All units, coarsest level first.
    pub fn units(&self) -> impl ExactSizeIterator<Item = UnitId> + use<> {
        self.index.units()
    }

    /// Number of units.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The level of a unit, 0 the finest.
    ///
    /// # Panics
    /// There must be such a unit.
    #[must_use]
    pub fn level_of(&self, unit: UnitId) -> u8 {
        self.index.numbers().level_of(unit)
    }

    /// The level of the roots.
    #[must_use]
    pub fn coarsest(&self) -> u8 {
        (self.description.units.len() - 1) as u8
    }

    /// What a unit's chunk says.
    ///
    /// # Errors
    /// It is no such unit.
    ///
    /// # Panics
    /// There must be such a unit.
    pub fn payload(&self, unit: UnitId, chunk: &[u8]) -> Result<Payload, PackError> {
        let read = Payload::parse(self.row(unit), &self.description, chunk);
        read.map_err(|source| PackError {
            field: format!("unit {}: {}", unit.0, source.field),
            ..source
        })
    }

    /// Place and checksum of a unit's chunk.
    ///
    /// # Panics
    /// There must be such a unit.
    #[must_use]
    pub fn entry(&self, unit: UnitId) -> Entry {
        self.index.entry(unit)
    }

    /// The pages of the index and of the table that cover a unit, with their bytes: what a reader
    /// over a network loads before the unit itself.
    #[must_use]
    pub fn pages_of(&self, unit: UnitId) -> [(u32, u64); 2] {
        let length = |place: core::ops::Range<u64>| place.end - place.start;
        let index = self.index.numbers().page_of(unit);
        let table = self.directory.page_of(unit.0).unwrap_or_default();
        let index_bytes = self.index.page_place(index).map_or(0, length);
        [
            (index, index_bytes),
            (table, length(self.directory.place(table))),
        ]
    }

    /// Bytes that come before any page: header, description, the directory of the table of units,
    /// and the table of objects where there is one.
    #[must_use]
    pub fn head_bytes(&self, header: &Header) -> u64 {
        let first = self.directory.place(0);
        let objects = self.description.objects_table().ok().flatten();
        header.data_offset() + first.start + objects.map_or(0, |table| table.bytes)
    }

    /// Whether chunks and side tables fill the file without gap or overlap.
    ///
    /// # Errors
    /// They do not.
    pub fn check_coverage(&self, header: &Header) -> Result<(), PackError> {
        self.index.check_coverage(header, &self.description.tables)
    }
}

impl SceneDescription {
    /// Where the side table of its objects lies, if it has one.
    ///
    /// # Errors
    /// It needs one and there is none, or one of another version.
    pub fn objects_table(&self) -> Result<Option<&TableEntry>, PackError> {
        if !self.has_object_table() {
            return Ok(None);
        }
        let table = self.tables.iter().find(|table| table.name == OBJECTS);
        match table.filter(|table| table.version == OBJECTS_VERSION) {
            Some(table) => Ok(Some(table)),
            None => {
                let found = table.map_or("none".to_owned(), |it| format!("version {}", it.version));
                let expected = format!("version {OBJECTS_VERSION}");
                Err(PackError::new("tables.objects", found, expected))
            }
        }
    }

    /// The same with the objects and textures of its side table; `table` is nothing where it has
    /// none.
    ///
    /// # Errors
    /// The table is damaged, or a number in it is out of range.
    pub fn with_objects(mut self, table: &[u8]) -> Result<Self, PackError> {
        let Some(entry) = self.objects_table()? else {
            return Ok(self);
        };
        check_crc(&format!("side table {OBJECTS}"), table, entry.crc32c)?;
        (self.objects, self.textures) = read_objects(table)?;
        self.check()?;
        Ok(self)
    }

    /// The description as it is written, and side tables: of its objects where it would be long,
    /// and of names that have no place in it.
    #[must_use]
    pub fn parted(mut self) -> (Self, Vec<SideTable>) {
        let length = serde_json::to_vec(&self).map_or(0, |json| json.len());
        let table = |name: &str, version, bytes| SideTable {
            name: name.to_owned(),
            version,
            bytes,
        };
        let mut tables = Vec::new();
        if length > LONG || !self.parts.iter().all(Vec::is_empty) {
            let names = write_names(&self.objects, &self.parts);
            tables.push(table(NAMES, NAMES_VERSION, names));
        }
        if length > LONG {
            let objects = write_objects(&self.objects, &self.textures);
            tables.push(table(OBJECTS, OBJECTS_VERSION, objects));
            (self.objects, self.textures) = (Vec::new(), Vec::new());
            self.needs.push(OBJECTS.to_owned());
        }
        self.parts = Vec::new();
        (self, tables)
    }

    /// Where the table of units lies.
    ///
    /// # Errors
    /// There is none, or one of another version.
    pub fn units_table(&self) -> Result<&TableEntry, PackError> {
        let mut tables = self.tables.iter();
        let table = tables.find(|table| table.name == UNITS);
        let wrong = |found: String| {
            PackError::new(
                "tables.units",
                found,
                format!("version {UNITS_VERSION}; prepare the scene again"),
            )
        };
        let table = table.ok_or_else(|| wrong("none".to_owned()))?;
        match table.version {
            UNITS_VERSION => Ok(table),
            version => Err(wrong(format!("version {version}"))),
        }
    }
}

/// The name of the chunk of a unit while its pack is written.
#[must_use]
pub fn chunk_name(unit: UnitId) -> ChunkName {
    let mut name = [0; 10];
    name[..4].copy_from_slice(&unit.0.to_le_bytes());
    ChunkName(name)
}

/// Begins the pack of a scene of about this description.
#[must_use]
pub fn begin_scene(draft: &SceneDescription) -> PackBuilder {
    let (draft, _) = draft.clone().parted();
    PackBuilder::new(&serde_json::to_vec(&draft).unwrap_or_default())
}

/// The bytes before and after the chunks of a scene, whose units have all been pushed by
/// [`chunk_name`] in the order of `rows`.
///
/// # Errors
/// A unit is missing, or the description does not fit.
pub fn finish_scene(
    builder: PackBuilder,
    description: SceneDescription,
    rows: &[UnitRow],
) -> Result<PackHead, PackError> {
    let numbers = numbers_of(&description)?;
    let (mut description, mut tables) = description.parted();
    let table = SideTable {
        name: UNITS.to_owned(),
        version: UNITS_VERSION,
        bytes: write_units(rows, description.page, &numbers),
    };
    let unit = |ChunkName(name): ChunkName| UnitId(crate::pack::u32_at(&name, 0));
    tables.push(table);
    builder.finish(&numbers, unit, &tables, |tables| {
        description.tables = tables;
        let json = serde_json::to_vec(&description);
        let json = json.map_err(|e| PackError::new("description", e, "valid JSON"))?;
        SceneDescription::parse(&json)?;
        Ok(json)
    })
}

/// Takes any bytes for a scene pack and reads all of it that can be read: the body of the fuzz
/// target. Returns whether they were one.
#[must_use]
pub fn parse_anything(data: &[u8]) -> bool {
    let Ok(header) = Header::parse(data) else {
        return false;
    };
    let part = |from: u64, bytes: u64| {
        let from = usize::try_from(from).ok()?;
        data.get(from..from.checked_add(usize::try_from(bytes).ok()?)?)
    };
    let description = part(HEADER_BYTES as u64, u64::from(header.description_bytes));
    let read = || {
        let mut about = ScenePack::describe(&header, description?).ok()?;
        if let Some(table) = about.objects_table().ok()?.cloned() {
            about = about.with_objects(part(table.offset, table.bytes)?).ok()?;
        }
        let table = about.units_table().ok()?;
        let table = part(table.offset, table.bytes)?;
        let index = part(header.index_offset, header.index_bytes)?;
        ScenePack::new(&header, about, index, table).ok()
    };
    let Some(pack) = read() else {
        return false;
    };
    for unit in pack.units() {
        let entry = pack.entry(unit);
        if let Some(chunk) = part(entry.offset, u64::from(entry.bytes)) {
            let _ = pack.payload(unit, chunk);
        }
    }
    pack.check_coverage(&header).is_ok()
}
