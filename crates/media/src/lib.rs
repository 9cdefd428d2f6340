//! Turns files into packs and packs into frames.

pub mod capture;
pub mod error;
mod ffmpeg;
pub mod generate;
pub mod pack;
mod parallel;
pub mod plain_file;
pub mod prepare;
pub mod read;
pub mod source_view;
pub mod sphere;
pub mod surround;
pub mod tiles;
pub mod write;

#[cfg(test)]
mod tests;

pub use crate::read::input::VideoInput;
pub use crate::read::options::{ReadOptions, TimedPicture};
pub use crate::read::source::SourceInfo;
pub use crate::surround::spherical::{Spherical, SphericalProjection, Stereo, StereoLayout};
pub use crate::tiles::decode::GroupDecoder;
pub use crate::tiles::encode::encode_group;
pub use crate::tiles::encode_settings::{EncodeSettings, Rate, Speed};
pub use crate::write::write_clip::{ClipCodec, ClipFormat, ClipWriter};
pub use error::MediaError;
pub use source_view::{SourcePicture, SourceView};
