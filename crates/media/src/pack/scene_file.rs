//! How is the pack of a scene written and read?

use crate::pack::damage::Damage;
use crate::pack::name_claim::NameClaim;
use crate::pack::open_pack::{OpenPack, PackFileError};
use crate::pack::pack_writer::{Looked, PackWriter};
use foveal_core::content::demand::Content;
use foveal_core::content::mesh::payload::MeshUnit;
use foveal_core::content::payload::Payload;
use foveal_core::content::scene::Scene;
use foveal_core::content::scene::description::SceneDescription;
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::content::scene::object_table::{NAMES, NAMES_VERSION, read_names};
use foveal_core::content::scene::pack::{ScenePack, begin_scene, chunk_name, finish_scene};
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::content::scene::whole::SceneCheck;
use foveal_core::pack::Header;
use foveal_core::pack::unit::UnitId;
use foveal_core::session::decoder::ByteSource;
use std::path::Path;
use std::sync::Arc;

/// Writes a scene whose units come in their order: to the name that was claimed, once it is whole
/// and was read back. Returns its bytes.
///
/// # Errors
/// The file cannot be written, the units do not fit the description, or what was written is not
/// what is read.
pub fn write_scene(
    claim: NameClaim,
    description: SceneDescription,
    units: impl Iterator<Item = (UnitRow, Vec<u8>)>,
) -> Result<u64, PackFileError> {
    let mut writer = PackWriter::begin(claim, begin_scene(&description))?;
    let mut rows = Vec::new();
    for (unit, (row, payload)) in (0..).map(UnitId).zip(units) {
        writer.push_chunk(chunk_name(unit), &payload)?;
        rows.push(row);
    }
    let finish = |builder| finish_scene(builder, description, &rows);
    let check = |partial: &Path| Ok(SceneFile::open(partial)?.verify(|_, _| ()));
    let look = |parts, _: &Path| Ok(Looked { parts, more: None });
    Ok(writer.end(finish, look, check)?.bytes)
}

/// An open scene pack: description, index and table of units in memory, chunks read when they are
/// asked for.
#[derive(Debug)]
pub struct SceneFile {
    open: Arc<OpenPack>,
    scene: Arc<Scene>,
}

impl SceneFile {
    /// Opens the pack of a scene.
    ///
    /// # Errors
    /// It cannot be read, is damaged, or of another kind.
    pub fn open(path: &Path) -> Result<Self, PackFileError> {
        let (open, description) = OpenPack::open(path)?;
        Self::read(open, &description)
    }

    pub(super) fn read(open: OpenPack, description: &[u8]) -> Result<Self, PackFileError> {
        let format = |source| open.format(source);
        let mut about = ScenePack::describe(open.header(), description).map_err(format)?;
        if let Some(table) = about.objects_table().map_err(format)? {
            let table = open.read_table(table)?;
            about = about.with_objects(&table).map_err(format)?;
        }
        let index = ScenePack::index_of(open.header(), &about).map_err(format)?;
        open.read_index(&index)?;
        let table = open.read_table(about.units_table().map_err(format)?)?;
        let pack = ScenePack::of_index(about, index, &table).map_err(format)?;
        let name = open.path().file_name().unwrap_or_default();
        let scene = Scene::new(&name.to_string_lossy(), Arc::new(pack));
        Ok(Self {
            scene: Arc::new(scene),
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

    /// What is in it.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Description, index and table of units.
    #[must_use]
    pub fn pack(&self) -> &ScenePack {
        self.scene.pack()
    }

    /// Where everything lies in the file.
    #[must_use]
    pub fn header(&self) -> &Header {
        self.open.header()
    }

    /// Bytes that come before any unit and page: header, description, directory of the table.
    #[must_use]
    pub fn head_bytes(&self) -> u64 {
        self.pack().head_bytes(self.header())
    }

    /// Bytes of the file.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.open.header().file_bytes
    }

    /// The names of objects, of each its own or those of the parts that it was joined of: from the
    /// table that nothing else needs, or the description.
    ///
    /// # Errors
    /// The table cannot be read, or is damaged.
    pub fn names(&self) -> Result<Vec<Vec<String>>, PackFileError> {
        let about = self.pack().description();
        let table = about.tables.iter().find(|table| table.name == NAMES);
        let Some(table) = table.filter(|table| table.version == NAMES_VERSION) else {
            let own = about.objects.iter().map(|object| vec![object.name.clone()]);
            return Ok(own.collect());
        };
        let read = read_names(&self.open.read_table(table)?);
        read.map_err(|source| self.open.format(source))
    }

    /// The chunk of a unit, its checksum checked.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn read_chunk(&self, unit: UnitId) -> Result<Vec<u8>, PackFileError> {
        let what = format!("chunk of unit {}", unit.0);
        self.open.read_chunk(self.scene.place(unit), &what)
    }

    /// A unit, read and parsed.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn read_unit(&self, unit: UnitId) -> Result<Payload, PackFileError> {
        let bytes = self.read_chunk(unit)?;
        let read = self.pack().payload(unit, &bytes);
        read.map_err(|source| self.open.format(source))
    }

    /// A unit of a mesh, read and parsed; of what is no mesh, one that has no triangle.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn read_mesh(&self, unit: UnitId) -> Result<MeshUnit, PackFileError> {
        if self.pack().row(unit).kind != UnitKind::Mesh {
            return Ok(MeshUnit::default());
        }
        match self.read_unit(unit)? {
            Payload::Mesh(mesh) => Ok(mesh),
            _ => Ok(MeshUnit::default()),
        }
    }

    /// Reads every byte once and checks it: `progress` receives how many bytes are done of how
    /// many. Returns what is damaged, nothing if all is well; of chunks or tables that overlap or
    /// leave gaps that alone.
    pub fn verify(&self, mut progress: impl FnMut(u64, u64)) -> Damage {
        if let Err(source) = self.pack().check_coverage(self.header()) {
            return Damage::tangled(self.open.format(source));
        }
        let mut damage = Damage::default();
        damage.add(self.names().map(|_| ()));
        let mut done = 0;
        let mut check = SceneCheck::new(self.pack());
        for unit in self.pack().units() {
            let read = self.read_unit(unit);
            if read.is_err() {
                check.miss(unit);
            }
            damage.add(read.and_then(|payload| {
                let fits = check.add(unit, &payload);
                fits.map_err(|source| self.open.format(source))
            }));
            done += u64::from(self.pack().entry(unit).bytes);
            progress(done, self.bytes());
        }
        damage
    }
}
