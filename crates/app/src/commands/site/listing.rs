//! What does a list of packs say of each?

use crate::commands::info::seconds_of;
use crate::commands::site::about::AboutPack;
use crate::commands::site::pack_names::ENDING;
use crate::commands::site::poster::Poster;
use crate::commands::site::site_pack::ListedKind;
use foveal_core::content::scene::description::SceneDescription;
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::view::surface::Projection;
use foveal_media::pack::pack::Pack;
use foveal_media::pack::pack_file::PackFile;
use serde::{Serialize, Serializer};

/// `packs.json`.
#[derive(Debug, Serialize)]
pub(super) struct Listing<'a> {
    /// Of this form.
    version: u32,
    generator: &'static str,
    packs: &'a [Listed],
}

/// Who wrote a list; an export replaces only sites that carry it.
pub(super) const GENERATOR: &str = concat!("foveal ", env!("CARGO_PKG_VERSION"));

impl<'a> Listing<'a> {
    pub(super) fn new(packs: &'a [Listed]) -> Self {
        Self {
            version: 1,
            generator: GENERATOR,
            packs,
        }
    }
}

/// A pack in a site; names are relative to the list.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Listed {
    pub(super) name: String,
    /// What people read of it.
    title: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    description: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    licence: Option<String>,
    pub(crate) file: String,
    pub(crate) poster: ListedPoster,
    bytes: u64,
    #[serde(flatten)]
    shows: Shows,
}

/// What is to be seen.
#[derive(Clone, Debug, Serialize)]
struct Shows {
    content: ListedKind,
    /// Null for a scene.
    projection: Option<Projection>,
    eyes: u8,
    /// Pixels of the source; null for a scene.
    width: Option<u32>,
    height: Option<u32>,
    /// Null for a picture and a scene.
    fps: Option<f64>,
    seconds: Option<f64>,
    sound: bool,
    /// Of a scene at its finest, each where it stands: what they are called, and how many.
    #[serde(flatten, serialize_with = "by_name")]
    samples: Vec<(String, u64)>,
}

fn by_name<S: Serializer>(samples: &[(String, u64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(samples.iter().map(|(name, count)| (name, count)))
}

impl Shows {
    fn of(pack: &Pack) -> anyhow::Result<Self> {
        match pack {
            Pack::Video(file) => Self::of_video(file, ListedKind::of(pack)),
            Pack::Scene(file) => Ok(Self::of_scene(file.pack().description())),
        }
    }

    fn of_video(file: &PackFile, content: ListedKind) -> anyhow::Result<Self> {
        let about = file.pack().description();
        let [width, height] = about.source.size.map(Some);
        Ok(Self {
            content,
            projection: Some(about.projection),
            eyes: about.eyes,
            width,
            height,
            fps: (!about.is_still()).then_some(about.fps()),
            seconds: seconds_of(file)?,
            sound: about.tables.iter().any(|table| table.name == "sound"),
            samples: Vec::new(),
        })
    }

    fn of_scene(about: &SceneDescription) -> Self {
        Self {
            content: ListedKind::Scene,
            projection: None,
            eyes: 1,
            width: None,
            height: None,
            fps: None,
            seconds: None,
            sound: false,
            samples: UnitKind::shapes()
                .map(|kind| (kind.facts().samples(), about.samples_of(kind)))
                .collect(),
        }
    }
}

/// The picture that stands for a pack in a list.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ListedPoster {
    pub(super) file: String,
    width: u32,
    height: u32,
}

impl Listed {
    pub(super) fn new(
        name: &str,
        file: &Pack,
        poster: &Poster,
        said: AboutPack,
    ) -> anyhow::Result<Self> {
        Ok(Self {
            name: name.to_owned(),
            title: said.title.unwrap_or_else(|| name.to_owned()),
            description: said.description,
            licence: said.licence,
            file: format!("{name}{ENDING}"),
            poster: ListedPoster {
                file: format!("posters/{name}.jpg"),
                width: poster.size[0],
                height: poster.size[1],
            },
            bytes: file.bytes(),
            shows: Shows::of(file)?,
        })
    }
}
