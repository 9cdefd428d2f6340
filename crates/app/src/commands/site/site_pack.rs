//! What does a site ask of a pack, whatever is in it?

use crate::commands::info::seconds_of;
use crate::commands::site::poster::{self, Poster};
use crate::report::output;
use anyhow::Context;
use foveal_core::content::scene::kind::UnitKind;
use foveal_core::view::surface::Projection;
use foveal_media::pack::pack::Pack;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::scene_file::SceneFile;
use foveal_render::DrawDevice;
use serde::{Serialize, Serializer};

/// What a list says of a pack, and the picture that stands for it there.
pub(super) fn shown(pack: &Pack, drawing: &DrawDevice) -> anyhow::Result<(Shows, Poster)> {
    let (shows, poster) = match pack {
        Pack::Video(file) => (Shows::of_video(file)?, poster::of_video(file, drawing)),
        Pack::Scene(file) => (Shows::of_scene(file), poster::of_scene(file, drawing)),
    };
    let why = || format!("{}: no poster can be drawn", pack.path().display());
    Ok((shows, poster.with_context(why)?))
}

/// What to say where a pack is larger than what it was made from, and gains little by that: flat
/// video.
pub(super) fn growth(pack: &Pack) -> Option<String> {
    let file = pack.video()?;
    let source = file.pack().description().source.bytes;
    let is_flat = file.pack().grid().surface.projection == Projection::Flat;
    (is_flat && source > 0 && file.bytes() > source).then(|| {
        format!(
            "warning: {}: {}, and its source {}; flat video on an ordinary link mostly costs more \
             bytes as a pack (docs/concepts/policies.md says what gains)",
            file.path().display(),
            output::size(file.bytes()),
            output::size(source)
        )
    })
}

/// What a pack of a list is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ListedKind {
    Picture,
    Video,
    Scene,
}

/// What is to be seen.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Shows {
    pub(super) content: ListedKind,
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
    pub(super) fn of_video(file: &PackFile) -> anyhow::Result<Self> {
        let about = file.pack().description();
        let [width, height] = about.source.size.map(Some);
        Ok(Self {
            content: match about.is_still() {
                true => ListedKind::Picture,
                false => ListedKind::Video,
            },
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

    pub(super) fn of_scene(file: &SceneFile) -> Self {
        let about = file.pack().description();
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
