//! A pack in, pictures out: opening, choosing, fetching, decoding and drawing, without command line
//! and window.
//!
//! [`Player`] makes frames one by one, for any view and gaze; [`LivePlayer`] plays while
//! something else goes on, as a window does. Both obey a
//! [`Session`](foveal_core::session::session::Session), which decides.

#![forbid(unsafe_code)]

mod decoding;
mod error;
mod feed;
mod live;
mod look;
mod mesh_reader;
mod player;
mod rendered_worth;
mod report;
mod scene_player;
#[cfg(test)]
mod scene_player_tests;
mod step;
mod tile_decoder;

pub use decoding::Decoding;
pub use error::PlayError;
pub use live::{LiveOptions, LivePlayer, Stepped};
pub use look::Look;
pub use player::{Player, PlayerOptions};
pub use rendered_worth::worth_both_ways;
pub use report::{ExpectedLoss, FrameReport};
pub use scene_player::{ScenePlayer, ScenePlayerOptions, SceneReport};
