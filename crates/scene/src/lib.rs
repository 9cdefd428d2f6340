//! 3D files in, units of a scene pack out; and files that say which displays show them.
//!
//! [`read`] turns files into a [`SourceScene`](source::SourceScene), [`build`] turns that into
//! units that a viewer can fetch in any order. Nothing here is needed to play: payloads are decoded
//! in `foveal-core`.

#![forbid(unsafe_code)]

pub mod baseline;
pub mod beneath;
pub mod build;
pub mod cracks;
pub mod generate;
pub mod laz_whole;
mod nearest;
mod plain_bytes;
pub mod read;
pub mod rig;
pub mod signatures;
pub mod source;
