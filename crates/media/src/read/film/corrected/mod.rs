//! What a file says wrongly of itself, and what is read in its place.

pub(crate) mod bytes;
pub mod corrections;
pub(crate) mod file;
mod mp4_edits;
pub mod mp4_says;
