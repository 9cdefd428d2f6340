//! What is asked of a build, and what comes of it?

use crate::source::Repairs;
use foveal_core::content::scene::description::{JoinedParts, SceneObject, SceneTexture};
use foveal_core::content::scene::unit_table::UnitRow;
use foveal_core::pack::PackError;

/// How a scene is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// Bits of a place along the largest extent of an object: 10 to 16.
    pub bits: u8,
    /// Number of threads; changes no byte.
    pub jobs: usize,
    /// Whether textures keep every texel as it is.
    pub exact: bool,
    /// Whether it is measured what units add: without, their signatures are zeros.
    pub signatures: bool,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            bits: 14,
            jobs: 1,
            exact: false,
            signatures: true,
        }
    }
}

/// A unit with its row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltUnit {
    /// Its level, 0 the finest; all roots have the coarsest.
    pub level: u8,
    /// What is known of it before it is fetched.
    pub row: UnitRow,
    /// What is fetched.
    pub payload: Vec<u8>,
}

/// A scene as units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Built {
    /// What stands in the scene.
    pub objects: Vec<SceneObject>,
    /// For each object the names of the parts that it was joined of; none where it is one by
    /// itself.
    pub parts: Vec<Vec<String>>,
    /// How many objects were joined.
    pub joined: JoinedParts,
    /// What its surfaces have.
    pub textures: Vec<SceneTexture>,
    /// All units; the place of one is its number. Coarsest level first, within a level meshes by
    /// object, then along a curve through space, then pages of textures.
    pub units: Vec<BuiltUnit>,
    /// Number of levels.
    pub levels: u8,
    /// What was repaired or left out: that of the source and that of the build.
    pub repairs: Repairs,
    /// What a person should know of the build.
    pub remarks: Vec<String>,
}

/// Why a scene cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// A number of bits that no grid has.
    #[error("bits of the grid: {0}; choose 10 to 16")]
    Bits(u8),
    /// Nothing that has an area, and no point.
    #[error("scene: no triangle with an area, and no point; choose files with meshes or points")]
    Empty,
    /// More than a pack can hold.
    #[error("scene: {0} objects; at most 65535 fit: join some, or make several packs")]
    Objects(usize),
    /// A source that contradicts itself.
    #[error("object {object}, {what}; mend the file")]
    Source {
        /// Name of the object.
        object: String,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The threads did not start.
    #[error("threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A unit could not be written.
    #[error("unit: {0}")]
    Unit(#[from] PackError),
}
