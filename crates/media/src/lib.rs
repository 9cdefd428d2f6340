//! Turns files into packs and packs into frames.

mod convert;
pub mod cube_layout;
mod cut_short;
pub mod decode;
pub mod decode_pool;
mod decode_streams;
pub mod decoders;
mod deliver;
pub mod encode;
mod encoder;
pub mod error;
pub mod eye_layout;
mod ffmpeg;
mod frame;
mod frame_file;
mod frame_reader;
pub mod generate;
mod hardware;
mod ijg_jpeg;
pub mod input;
mod journal_file;
mod large_still;
mod orientation;
pub mod pack_file;
mod pack_writer;
mod parallel;
pub mod photo_sphere;
pub mod picture_from_rgba;
pub mod prepare;
pub mod pyramid;
mod pyramid_light;
mod rate_search;
pub mod sound;
mod sound_reader;
pub mod source;
pub mod source_view;
pub mod sphere;
pub mod sphere_part;
pub mod spherical;
pub mod spherical_boxes;
mod stacked_png;
pub mod still_tags;
mod timeline;
pub mod write_clip;

#[cfg(test)]
mod broken_tests;
#[cfg(test)]
mod codec_tests;
#[cfg(test)]
mod decode_pool_tests;
#[cfg(test)]
mod format_tests;
#[cfg(test)]
mod input_tests;
#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod pack_tests;
#[cfg(test)]
mod resume_tests;
#[cfg(test)]
mod scenes;
#[cfg(test)]
mod side_table_tests;
#[cfg(test)]
mod sound_tests;

pub use decode::GroupDecoder;
pub use encode::{EncodeSettings, Rate, Speed, encode_group};
pub use error::MediaError;
pub use input::{TimedPicture, VideoInput};
pub use source::SourceInfo;
pub use source_view::{SourcePicture, SourceView};
pub use spherical::{Projection, Spherical, Stereo, StereoLayout};
pub use write_clip::{ClipCodec, ClipFormat, ClipWriter};
