//! Where does a pixel of one of many displays look, and which place of one source does it show?
//!
//! Normative for the file that describes them: docs/formats/panels.md. Angles are radians, lengths
//! are in distances from the eye to the panel, places are pixels with centres at +0.5, rows down.

pub mod alpha;
mod curved;
pub mod distortion;
pub mod fit;
pub mod footprint;
mod hull;
pub mod lens;
pub mod pixel_map;
pub mod placement;
mod plane;
pub mod residual_grid;
pub mod rig;
mod samples;
pub mod seed;
pub mod share;
#[cfg(test)]
pub(crate) mod tests;
