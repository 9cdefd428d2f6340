//! What is known of a pack that is loaded in parts?

use crate::options::Options;
use foveal_core::content::opened::Opened;
use foveal_core::content::payload::Payload;
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::description::SceneDescription;
use foveal_core::content::scene::pack::{ScenePack, is_scene};
use foveal_core::content::video::Video;
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::pack::unit::UnitId;
use foveal_core::pack::{HEADER_BYTES, Header, PackError, check_crc};
use foveal_core::session::bounds::{Bounds, CLIENT_BYTES};
use foveal_core::units::{Radians, counted};
use foveal_core::view::navigation::Navigation;
use foveal_core::view::surface::Screen;
use foveal_render::{DrawDevice, Drawer, RenderError, TileStyle};
use std::ops::Range;
use std::sync::Arc;

/// What a page keeps below of a video: its memory holds 4 GiB at most, of which decoded pictures
/// may take a quarter, and phones have little more for graphics.
const OF_VIDEO: Bounds = Bounds {
    in_flight: 512 << 20,
    cached: 1 << 30,
    gpu: 2 << 30,
    client: CLIENT_BYTES,
};
/// The same of a scene, whose units stay on the GPU as long as they are seen. Few are asked for at
/// once, so that turning away is not delayed by stale requests.
const OF_SCENE: Bounds = Bounds {
    in_flight: 8 << 20,
    cached: 256 << 20,
    gpu: 256 << 20,
    client: CLIENT_BYTES,
};

/// A pack of which all has been loaded that comes before its units.
pub(crate) struct PackInParts {
    pub(crate) header: Header,
    /// What it holds: of a video, pages of the index and side tables come while it plays; of a
    /// scene, index and table of units are there.
    pub(crate) content: Opened,
}

/// The beginning of a pack.
pub(crate) enum Head<'a> {
    /// The description of a video, as it is written.
    Video(&'a [u8]),
    Scene(Box<SceneDescription>),
}

impl<'a> Head<'a> {
    /// Header and description of a pack that begins with `head`.
    pub(crate) fn read(head: &'a [u8]) -> Result<(Header, Self), PackError> {
        let header = Header::parse(head)?;
        let end = HEADER_BYTES + header.description_bytes as usize;
        let Some(description) = head.get(HEADER_BYTES..end) else {
            let found = format!("{} of the file", counted(head.len(), "byte"));
            return Err(wrong("description", found, end));
        };
        check_crc("description", description, header.description_crc)?;
        let head = match is_scene(description) {
            true => Self::Scene(Box::new(ScenePack::describe(&header, description)?)),
            false => Self::Video(description),
        };
        Ok((header, head))
    }

    /// The stretches of the file that are needed besides the head before a pack can be opened: of a
    /// scene the index, the table of units, and the table of objects where it has one.
    pub(crate) fn stretches(&self, header: &Header) -> Result<Vec<Range<u64>>, PackError> {
        let Self::Scene(about) = self else {
            return Ok(Vec::new());
        };
        let tables = [Some(about.units_table()?), about.objects_table()?];
        let index = header.index_offset..header.index_offset + header.index_bytes;
        let mut stretches = Vec::from([index]);
        for table in tables.into_iter().flatten() {
            let place = table.offset..table.offset.saturating_add(table.bytes);
            if place.end > header.file_bytes {
                let within = format!("within {}", counted(header.file_bytes, "byte"));
                let field = format!("tables.{}", table.name);
                return Err(wrong(&field, format!("bytes {place:?}"), within));
            }
            stretches.push(place);
        }
        Ok(stretches)
    }
}

impl PackInParts {
    /// The pack that begins with `head`, called `name` in logs, flat content filling `screen`.
    /// `rest` is what [`Head::stretches`] names, one after the other.
    pub(crate) fn open(
        head: &[u8],
        rest: &[u8],
        name: &str,
        screen: Screen,
    ) -> Result<Self, PackError> {
        let (header, head) = Head::read(head)?;
        let content = match head {
            Head::Video(description) => {
                let pack = Arc::new(VideoPack::begin(&header, description)?);
                Opened::Video(Arc::new(Video::new(name, pack, screen)))
            }
            Head::Scene(about) => {
                let index = rest.len().min(header.index_bytes as usize);
                let (index, tables) = rest.split_at(index);
                let units = tables.len().min(about.units_table()?.bytes as usize);
                let (table, objects) = tables.split_at(units);
                let about = about.with_objects(objects)?;
                let pack = Arc::new(ScenePack::new(&header, about, index, table)?);
                Opened::Scene(Arc::new(Scene::new(name, pack)))
            }
        };
        Ok(Self { header, content })
    }

    /// Where a viewer begins.
    pub(crate) fn navigation(&self, options: &Options) -> Navigation {
        let field = Radians::from_degrees(options.field_deg);
        self.content.navigation(field)
    }

    /// What a session keeps below.
    pub(crate) fn bounds(&self) -> Bounds {
        match &self.content {
            Opened::Video(_) => OF_VIDEO,
            Opened::Scene(_) => OF_SCENE,
        }
    }

    /// What draws it; nothing is resident yet.
    pub(crate) fn drawer(&self, device: &DrawDevice) -> Result<Drawer, RenderError> {
        match &self.content {
            Opened::Video(video) => Drawer::new(device, video, TileStyle::default()),
            Opened::Scene(scene) => Drawer::of_scene(device, scene, OF_SCENE.gpu),
        }
    }

    /// Where a side table that comes later lies in the file; `None` where no table has that
    /// name.
    pub(crate) fn table_place(&self, name: &str) -> Option<Range<u64>> {
        let table = self.content.video()?.table(name)?;
        let end = table.offset.checked_add(table.bytes)?;
        (end <= self.header.file_bytes).then_some(table.offset..end)
    }

    /// What a unit's chunk holds, where no decoder but this one reads it: of a scene.
    pub(crate) fn payload(&self, unit: UnitId, chunk: &[u8]) -> Result<Payload, PackError> {
        let field = || format!("chunk of unit {}", unit.0);
        let Opened::Scene(scene) = &self.content else {
            return Err(wrong(&field(), "of a video", "of a scene"));
        };
        if unit.0 as usize >= scene.pack().len() {
            return Err(wrong(&field(), "no such unit", "one of the pack"));
        }
        check_crc(&field(), chunk, scene.pack().entry(unit).crc32c)?;
        scene.pack().payload(unit, chunk)
    }
}

fn wrong(field: &str, found: impl ToString, expected: impl ToString) -> PackError {
    PackError {
        field: field.to_owned(),
        found: found.to_string(),
        expected: expected.to_string(),
    }
}
