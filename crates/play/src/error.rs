//! Why can a pack not be played?

use foveal_render::RenderError;
use std::error::Error;
use thiserror::Error;

/// Why a pack cannot be played, and what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlayError {
    /// It cannot be read, or is damaged.
    #[cfg(feature = "native")]
    #[error(transparent)]
    Pack(#[from] foveal_media::pack::pack_file::PackFileError),
    /// It cannot be decoded.
    #[cfg(feature = "native")]
    #[error(transparent)]
    Media(#[from] foveal_media::MediaError),
    /// It cannot be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// No thread decodes.
    #[error("no thread can be had for decoding")]
    Thread(#[source] std::io::Error),
    /// It lacks what the policy chooses by.
    #[error("{pack}: {what}")]
    Lacks {
        /// The pack.
        pack: String,
        /// What it lacks, and what to do.
        what: &'static str,
    },
    /// All is damaged that could be shown by itself.
    #[error(transparent)]
    Damaged(Box<dyn Error + Send + Sync>),
    /// A tile of the coarsest level is damaged: there is nothing to show in its place.
    #[error("{pack}: frame {frame} of the coarsest level, which must be whole")]
    Coarsest {
        /// The pack.
        pack: String,
        /// The frame.
        frame: u32,
        /// What is damaged.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A decoder made something else than what it was asked for.
    #[error(transparent)]
    Wrong(Box<dyn Error + Send + Sync>),
}
