//! How is a pack opened whose kind is not known yet?

use crate::error::MediaError;
use crate::pack::damage::Damage;
use crate::pack::open_pack::{OpenPack, PackFileError};
use crate::pack::pack_file::PackFile;
use crate::pack::scene_file::SceneFile;
use crate::tiles::decode_pool::DecodePool;
use crate::tiles::decoders::DecoderChoice;
use foveal_core::content::opened::{ContentFacts, Opened};
use foveal_core::content::scene::pack::is_scene;
use foveal_core::session::decoder::{ByteSource, Decoder, Parser};
use foveal_core::view::surface::Screen;
use std::path::Path;
use std::sync::Arc;

/// Tiles under way for each decoding thread.
const TILES_AHEAD: usize = 2;
/// Units of a scene that are read whatever is wanted next.
const UNITS_AHEAD: usize = 4;

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

    /// What follows from what it holds.
    #[must_use]
    pub fn facts(&self) -> &'static ContentFacts {
        match self {
            Self::Video(_) => &ContentFacts::VIDEO,
            Self::Scene(_) => &ContentFacts::SCENE,
        }
    }

    /// What decodes it, by the processor or a device as chosen, on so many threads; and how many
    /// pieces are best under way at once.
    ///
    /// # Errors
    /// Nothing decodes it.
    pub fn decoder(
        &self,
        jobs: usize,
        choice: DecoderChoice,
    ) -> Result<(Box<dyn Decoder>, usize), MediaError> {
        Ok(match self {
            Self::Video(file) => {
                let pool = DecodePool::choosing(file, jobs, choice)?;
                (Box::new(pool), jobs.max(1) * TILES_AHEAD)
            }
            Self::Scene(_) => (Box::<Parser>::default(), UNITS_AHEAD),
        })
    }

    /// The source of its bytes.
    #[must_use]
    pub fn source(&self) -> Arc<dyn ByteSource> {
        match self {
            Self::Video(file) => file.source(),
            Self::Scene(file) => file.source(),
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
