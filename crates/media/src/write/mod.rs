//! Clips and frames written to files.

pub(crate) mod frame_file;
pub mod picture_from_rgba;
pub mod write_clip;
