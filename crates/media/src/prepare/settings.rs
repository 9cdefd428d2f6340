//! What can be asked of a preparation?

use crate::read::film::deinterlace::Deinterlace;
use crate::read::options::ReadOptions;
use crate::tiles::encode_settings::Speed;
use foveal_core::content::video::bytes::codec::Codec;
use foveal_core::content::video::grid::tile_grid::Cut;
use foveal_core::view::surface::Mapping;

/// Sizes that faces may be resampled to, in pixels.
pub(super) const FACE_SIZES: core::ops::RangeInclusive<u32> = 16..=32_768;

/// What the caller asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct PrepareSettings {
    /// Projection of the input.
    pub projection: ProjectionChoice,
    /// Where in a frame the pictures of the eyes lie.
    pub stereo: StereoChoice,
    /// Whether what would be mended is refused.
    pub strict: bool,
    /// What becomes of interlaced film.
    pub deinterlace: Deinterlace,
    /// Whether its sound comes along.
    pub sound: bool,
    /// How a pack shows what lies all around.
    pub pack_projection: SpherePack,
    /// How pixels lie over the faces of a cube that is resampled; equi-angular if `None`.
    pub mapping: Option<Mapping>,
    /// Pixels on a side of such a face; by size of the source if `None`.
    pub face_size: Option<u32>,
    /// How pictures are cut; by size of the source if `None`.
    pub cut: Option<Cut>,
    /// Number of levels; five, fewer for tiny pictures, if `None`.
    pub levels: Option<u8>,
    /// Linear ratio between levels.
    pub ratio: u32,
    /// Codec of the tiles.
    pub codec: Codec,
    /// Quality or bit rate of the levels; the codec's default quantiser if `None`.
    pub quality: Option<Quality>,
    /// Time against size.
    pub speed: Speed,
    /// Threads.
    pub jobs: usize,
    /// Stop after this many frames.
    pub most_frames: Option<u32>,
}

impl Default for PrepareSettings {
    /// What `foveal prepare video` does without options, on one thread.
    fn default() -> Self {
        Self {
            projection: ProjectionChoice::Auto,
            stereo: StereoChoice::Auto,
            strict: false,
            deinterlace: Deinterlace::default(),
            sound: true,
            pack_projection: SpherePack::Cube,
            mapping: None,
            face_size: None,
            cut: None,
            levels: None,
            ratio: 2,
            codec: Codec::Vp9,
            quality: None,
            speed: Speed::Default,
            jobs: 1,
            most_frames: None,
        }
    }
}

impl PrepareSettings {
    /// How the input is read.
    #[must_use]
    pub fn reading(&self) -> ReadOptions {
        ReadOptions {
            strict: self.strict,
            deinterlace: self.deinterlace,
        }
    }
}

/// What the caller says about the projection of the input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectionChoice {
    /// Find it from metadata, name and size.
    #[default]
    Auto,
    /// A flat picture.
    Flat,
    /// The whole sphere, longitude across and latitude down.
    Equirect,
    /// The front half of the sphere (VR180).
    HalfEquirect,
    /// Faces of a cube, laid out as their metadata or their shape says.
    Cube,
}

/// How a pack shows what lies all around: Kastner 2016, section 3.3.2, names both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpherePack {
    /// On the faces of a cube.
    #[default]
    Cube,
    /// On one equirectangular picture; one that is whole keeps its pixels as they are.
    Equirect,
}

/// What the caller says about the two eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StereoChoice {
    /// Find it from metadata and name.
    #[default]
    Auto,
    /// One picture for both eyes.
    Mono,
    /// Next to each other.
    SideBySide,
    /// One above the other.
    TopBottom,
}

/// What the caller asks for: one value for all levels, or one a level, finest first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Quantisers that follow what is seen: those of levels are looked for, and a tile's goes by
    /// its light and texture. Of film in VP9; else the codec's default quantiser.
    Auto,
    /// Fixed quantisers, lower is finer.
    Quantiser(Vec<u8>),
    /// JPEG qualities on the scale of the Independent JPEG Group, 1 to 100, higher is finer.
    Ijg(Vec<u8>),
    /// Bits per second of each tile.
    BitRate(Vec<u32>),
}
