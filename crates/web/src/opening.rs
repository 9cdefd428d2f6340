//! What must come of a pack before it is open?

use crate::stretches::{Arrival, Need, Part};
use foveal_core::content::scene::description::SceneDescription;
use foveal_core::content::scene::pack::{ScenePack, is_scene};
use foveal_core::content::video::bytes::pack::VideoPack;
use foveal_core::pack::{HEADER_BYTES, Header, PackError, check_crc};
use std::ops::Range;
use std::sync::Arc;

/// A pack that is being opened.
#[derive(Debug, Default)]
pub struct Opening {
    stage: Stage,
}

/// An open pack: of a video pages of the index and side tables still come, of a scene all is there
/// but its units. All that play it share what has come.
#[derive(Clone, Debug)]
pub struct OpenPack {
    pub(crate) header: Header,
    pub(crate) kind: PackKind,
}

#[derive(Clone, Debug)]
pub(crate) enum PackKind {
    Video(Arc<VideoPack>),
    Scene(Arc<ScenePack>),
}

/// What has come.
#[derive(Debug, Default)]
enum Stage {
    #[default]
    Nothing,
    Header(Header),
    /// Of a scene the description, and these of the stretches that are needed besides.
    Scene(Header, Box<SceneDescription>, Vec<Stretch>),
    All(OpenPack),
}

/// A place in the file, and its bytes once they are there.
type Stretch = (Range<u64>, Option<Vec<u8>>);

impl Opening {
    /// What is to be fetched now; nothing once the pack is open.
    #[must_use]
    pub fn needs(&self) -> Vec<Need> {
        let need = |place| Need::of(Part::Beginning, place);
        match &self.stage {
            Stage::Nothing => vec![need(0..HEADER_BYTES as u64)],
            Stage::Header(header) => vec![need(0..header.data_offset())],
            Stage::Scene(_, _, stretches) => {
                let missing = stretches.iter().filter(|(_, bytes)| bytes.is_none());
                missing.map(|(place, _)| need(place.clone())).collect()
            }
            Stage::All(_) => Vec::new(),
        }
    }

    /// Takes what [`Self::needs`] asked for; says what is wrong with it.
    pub fn arrived(&mut self, offset: u64, bytes: &[u8]) -> Result<Arrival, PackError> {
        let stage = std::mem::take(&mut self.stage);
        self.stage = stage.with(offset, bytes)?;
        Ok(Arrival::More)
    }

    /// Bytes of the file, once its header says so.
    #[must_use]
    pub fn file_bytes(&self) -> Option<u64> {
        match &self.stage {
            Stage::Nothing => None,
            Stage::Header(header) | Stage::Scene(header, ..) => Some(header.file_bytes),
            Stage::All(pack) => Some(pack.header.file_bytes),
        }
    }

    /// The pack, once it is open.
    #[must_use]
    pub fn open(&self) -> Option<&OpenPack> {
        match &self.stage {
            Stage::All(pack) => Some(pack),
            _ => None,
        }
    }
}

impl Stage {
    fn with(self, offset: u64, bytes: &[u8]) -> Result<Self, PackError> {
        match self {
            Self::Nothing => Ok(Self::Header(Header::parse(bytes)?)),
            Self::Header(header) => {
                let description = bytes.get(HEADER_BYTES..).unwrap_or_default();
                described(header, description)
            }
            Self::Scene(header, about, mut stretches) => {
                let place = offset..offset + bytes.len() as u64;
                let awaited = |it: &&mut Stretch| it.0 == place && it.1.is_none();
                if let Some((_, came)) = stretches.iter_mut().find(awaited) {
                    *came = Some(bytes.to_vec());
                }
                scene_of(header, about, stretches)
            }
            Self::All(pack) => Ok(Self::All(pack)),
        }
    }
}

/// The pack of a video, or what is needed besides of a scene.
fn described(header: Header, description: &[u8]) -> Result<Stage, PackError> {
    check_crc("description", description, header.description_crc)?;
    if !is_scene(description) {
        let kind = PackKind::Video(Arc::new(VideoPack::begin(&header, description)?));
        return Ok(Stage::All(OpenPack { header, kind }));
    }
    let about = Box::new(ScenePack::describe(&header, description)?);
    let index = header.index_offset..header.index_offset + header.index_bytes;
    let mut stretches = vec![(index, None)];
    let tables = [Some(about.units_table()?), about.objects_table()?];
    for table in tables.into_iter().flatten() {
        stretches.push((table.range(header.file_bytes)?, None));
    }
    Ok(Stage::Scene(header, about, stretches))
}

/// The pack of a scene, once index and tables are there.
fn scene_of(
    header: Header,
    about: Box<SceneDescription>,
    stretches: Vec<Stretch>,
) -> Result<Stage, PackError> {
    let all: Option<Vec<&[u8]>> = stretches
        .iter()
        .map(|(_, bytes)| bytes.as_deref())
        .collect();
    let Some(&[index, units, ref objects @ ..]) = all.as_deref() else {
        return Ok(Stage::Scene(header, about, stretches));
    };
    let about = about.with_objects(objects.first().copied().unwrap_or_default())?;
    let pack = ScenePack::new(&header, about, index, units)?;
    let kind = PackKind::Scene(Arc::new(pack));
    Ok(Stage::All(OpenPack { header, kind }))
}
