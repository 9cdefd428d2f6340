//! Where does a pixel of one of many displays look, and which place of one source does it show?
//!
//! Normative for the file that describes them: docs/formats/panels.md. Angles are radians, lengths
//! are in distances from the eye to the panel, places are pixels with centres at +0.5, rows down.

pub mod alpha;
pub mod distortion;
pub mod drawn_grid;
pub mod eye_blur;
pub mod fading;
pub mod fit;
pub mod footprint;
pub mod lens;
pub mod pixel_map;
pub mod placement;
mod placing;
pub mod residual_grid;
pub mod rig;
pub mod seed;
pub mod share;
#[cfg(test)]
pub(crate) mod tests;
