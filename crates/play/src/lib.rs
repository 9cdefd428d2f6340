//! A pack in, pictures out: opening, choosing, fetching, decoding and drawing, without command line
//! and window.
//!
//! [`Player`] plays any pack, natively and in a page: it obeys a
//! [`Session`](foveal_core::session::session::Session), which decides, and is brought what that
//! wants by a [`Supply`]. The feature `native` adds what reads files and decodes, and makes
//! pictures one by one: [`FramePlayer`] of video, [`Player::of_scene`] of scenes.

#![forbid(unsafe_code)]

mod error;
mod player;
mod supply;

#[cfg(feature = "native")]
mod at_once;
#[cfg(feature = "native")]
mod feed;
#[cfg(feature = "native")]
mod frames;
#[cfg(feature = "native")]
mod judging;
#[cfg(feature = "native")]
mod making;
#[cfg(feature = "native")]
mod options;
#[cfg(feature = "native")]
mod rendered_worth;
#[cfg(feature = "native")]
mod report;
#[cfg(feature = "native")]
mod run_memory;
#[cfg(test)]
#[cfg(feature = "native")]
mod scene_tests;
#[cfg(feature = "native")]
mod scenes;
#[cfg(feature = "native")]
mod watched_frame;

pub use error::PlayError;
pub use player::{Player, Stepped};
pub use supply::{Outside, Supply};

#[cfg(feature = "native")]
pub use {
    frames::FramePlayer,
    making::Made,
    options::{Decoding, FrameOptions, PlayerOptions},
    rendered_worth::worth_both_ways,
    report::{ExpectedLoss, FrameReport},
    watched_frame::WatchedFrame,
};
