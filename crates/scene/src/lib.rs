//! 3D files in, units of a scene pack out.
//!
//! [`read`] turns files into a [`SourceScene`](source::SourceScene), [`build`] turns that into
//! units that a viewer can fetch in any order. Nothing here is needed to play: payloads are decoded
//! in `foveal-core`.

#![forbid(unsafe_code)]

pub mod baseline;
pub mod build;
pub mod cracks;
pub mod generate;
pub mod laz_whole;
pub mod read;
pub mod signatures;
pub mod source;
