//! Why can a pack not be prepared?

use super::settings::FACE_SIZES;
use crate::error::MediaError;
use crate::pack::pack_file::PackFileError;
use foveal_core::content::video::grid::tile_grid::GridError;
use thiserror::Error;

/// Why a pack could not be prepared.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The input cannot be read, or a tile not coded.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// The pack cannot be written.
    #[error(transparent)]
    Pack(#[from] PackFileError),
    /// The tiles asked for cannot be.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// Faces cannot have this many pixels on a side.
    #[error(
        "--face-size {0}: expected a multiple of 16 from {from} to {to}",
        from = FACE_SIZES.start(),
        to = FACE_SIZES.end()
    )]
    FaceSize(u32),
    /// An option does not fit the input.
    #[error("{0}")]
    Option(String),
    /// Something would have to be mended, which was not to be.
    #[error("{0}: {1}; leave --strict out to have it repaired and reported")]
    Strict(String, String),
    /// It is not what it was when its preparation began.
    #[error("{0} changed while it was read; wait until it is finished, then prepare it again")]
    Changed(String),
    /// There is nothing in it.
    #[error("{0} has no frames; give a file with at least one picture")]
    NoFrames(String),
}
