//! What does a site ask of a pack, whatever is in it?

use crate::commands::site::poster::{self, Poster};
use crate::report::output;
use foveal_core::view::surface::Projection;
use foveal_media::pack::damage::Damage;
use foveal_media::pack::pack_file::PackFile;
use foveal_media::pack::pack_file::PackFileError;
use foveal_media::pack::scene_file::{SceneFile, is_scene_pack};
use foveal_render::DrawDevice;
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// An open pack.
pub(super) enum SitePack {
    Video(Arc<PackFile>),
    Scene(Box<SceneFile>),
}

impl SitePack {
    /// Opens a pack of either kind.
    pub(super) fn open(path: &Path) -> Result<Self, PackFileError> {
        if is_scene_pack(path) {
            return Ok(Self::Scene(Box::new(SceneFile::open(path)?)));
        }
        Ok(Self::Video(Arc::new(PackFile::open(path)?)))
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Video(file) => file.path(),
            Self::Scene(file) => file.path(),
        }
    }

    /// Bytes of the file.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Video(file) => file.bytes(),
            Self::Scene(file) => file.bytes(),
        }
    }

    /// The picture that stands for it.
    pub(super) fn poster(&self, drawing: &DrawDevice) -> anyhow::Result<Poster> {
        match self {
            Self::Video(file) => poster::of_video(Arc::clone(file), drawing),
            Self::Scene(file) => poster::of_scene(file, drawing),
        }
    }

    /// Reads all of it; `progress` receives how many bytes are done of how many. Returns what is
    /// damaged.
    pub(super) fn verify(&self, progress: impl FnMut(u64, u64)) -> Damage {
        match self {
            Self::Video(file) => file.verify(progress),
            Self::Scene(file) => file.verify(progress),
        }
    }

    /// What to say where it is larger than what it was made from, and gains little by that: flat
    /// video.
    pub(super) fn growth(&self) -> Option<String> {
        let Self::Video(file) = self else {
            return None;
        };
        let source = file.pack().description().source.bytes;
        let is_flat = file.pack().grid().surface.projection == Projection::Flat;
        (is_flat && source > 0 && file.bytes() > source).then(|| {
            format!(
                "warning: {}: {}, and its source {}; flat video on an ordinary link mostly costs \
                 more bytes as a pack (docs/concepts/policies.md says what gains)",
                file.path().display(),
                output::size(file.bytes()),
                output::size(source)
            )
        })
    }
}

/// What a pack of a list is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ListedKind {
    Picture,
    Video,
    Scene,
}

impl ListedKind {
    pub(super) fn of(file: &SitePack) -> Self {
        match file {
            SitePack::Scene(_) => Self::Scene,
            SitePack::Video(file) if file.pack().description().is_still() => Self::Picture,
            SitePack::Video(_) => Self::Video,
        }
    }
}
