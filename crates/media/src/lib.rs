//! Turns files into packs and packs into frames.

mod convert;
mod cut_short;
pub mod decode;
pub mod decode_pool;
mod deliver;
pub mod encode;
pub mod error;
mod ffmpeg;
mod frame;
mod frame_file;
mod frame_reader;
pub mod input;
mod orientation;
pub mod pack_file;
mod pack_writer;
mod parallel;
pub mod picture_from_rgba;
pub mod prepare;
pub mod pyramid;
pub mod sphere;
