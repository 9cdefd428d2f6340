//! How is a pack opened whose kind is not known yet?

use crate::pack::damage::Damage;
use crate::pack::open_pack::{OpenPack, PackFileError};
use crate::pack::pack_file::PackFile;
use crate::pack::scene_file::SceneFile;
use foveal_core::content::opened::Opened;
use foveal_core::content::scene::pack::is_scene;
use foveal_core::view::surface::Screen;
use std::path::Path;
use std::sync::Arc;

/// An open pack of any kind: description and index in memory, chunks read when they are asked for.
#[derive(Clone, Debug)]
pub enum Pack {
    /// A pack of a film or still.
    Video(Arc<PackFile>),
    /// A pack of a scene.
    Scene(Arc<SceneFile>),
}

impl Pack {
    /// Opens a pack and reads its header, description and index.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn open(path: &Path) -> Result<Self, PackFileError> {
        let (open, description) = OpenPack::open(path)?;
        Ok(match is_scene(&description) {
            true => Self::Scene(Arc::new(SceneFile::read(open, &description)?)),
            false => Self::Video(Arc::new(PackFile::read(open, &description)?)),
        })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::Video(file) => file.path(),
            Self::Scene(file) => file.path(),
        }
    }

    /// Bytes of the file.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Video(file) => file.bytes(),
            Self::Scene(file) => file.bytes(),
        }
    }

    /// Number of units.
    #[must_use]
    pub fn units(&self) -> usize {
        match self {
            Self::Video(file) => file.pack().units().count(),
            Self::Scene(file) => file.pack().len(),
        }
    }

    /// The video file; `None` of a scene.
    #[must_use]
    pub fn video(&self) -> Option<&Arc<PackFile>> {
        match self {
            Self::Video(file) => Some(file),
            Self::Scene(_) => None,
        }
    }

    /// The scene file; `None` of a video.
    #[must_use]
    pub fn scene(&self) -> Option<&Arc<SceneFile>> {
        match self {
            Self::Video(_) => None,
            Self::Scene(file) => Some(file),
        }
    }

    /// What is in it, with the tables by which units are chosen; flat content fills `screen`.
    ///
    /// # Errors
    /// A table is damaged.
    pub fn opened(&self, screen: Screen) -> Result<Opened, PackFileError> {
        Ok(match self {
            Self::Video(file) => Opened::Video(file.video(screen)?),
            Self::Scene(file) => Opened::Scene(Arc::clone(file.scene())),
        })
    }

    /// Reads every byte once and checks it: `progress` receives how many bytes are done of how
    /// many. Returns what is damaged, nothing if all is well.
    pub fn verify(&self, progress: impl FnMut(u64, u64)) -> Damage {
        match self {
            Self::Video(file) => file.verify(progress),
            Self::Scene(file) => file.verify(progress),
        }
    }
}
