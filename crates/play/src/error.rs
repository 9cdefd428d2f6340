//! Why can a pack not be played?

use foveal_core::content::video::grid::tile_grid::Tile;
use foveal_media::MediaError;
use foveal_media::pack::pack_file::PackFileError;
use foveal_media::tiles::decode_pool::TileError;
use foveal_render::RenderError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a pack cannot be played, and what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlayError {
    /// It cannot be read, or is damaged.
    #[error(transparent)]
    Pack(#[from] PackFileError),
    /// It cannot be decoded.
    #[error(transparent)]
    Media(#[from] MediaError),
    /// It cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// No thread decodes.
    #[error("no thread can be had for decoding")]
    Thread(#[source] std::io::Error),
    /// It lacks what the policy chooses by.
    #[error("{}: {what}", path.display())]
    Lacks {
        /// The pack.
        path: PathBuf,
        /// What it lacks, and what to do.
        what: &'static str,
    },
    /// A tile of the coarsest level is damaged: there is nothing to show in its place.
    #[error("{}: frame {frame} of the coarsest level, which must be whole", path.display())]
    Coarsest {
        /// The pack.
        path: PathBuf,
        /// The frame.
        frame: u32,
        /// What is wrong with the tile.
        source: TileError,
    },
    /// A decoder gave another frame than it was asked for.
    #[error(
        "{}: asked for frame {frame} of {tile:?}, the decoder gave {number}",
        path.display()
    )]
    WrongFrame {
        /// The pack.
        path: PathBuf,
        /// The tile.
        tile: Tile,
        /// The frame that was asked for.
        frame: u32,
        /// The frame that came.
        number: i64,
    },
}
