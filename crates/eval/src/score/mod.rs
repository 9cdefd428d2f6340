//! How good does a picture look to an eye that looks at a place in it?
//!
//! A clean implementation of the steps of FovVideoVDP 1.2 (Mantiuk et al. 2021, *FovVideoVDP: a
//! visible difference predictor for wide field-of-view video*, ACM TOG 40(4), article 49): display,
//! temporal channels, pyramid, contrast, sensitivity, masking, pooling. [`clear`] is the text that
//! follows the equations, in double precision; [`fast`] does the same in single precision on all
//! cores, and with the feature `gpu` the module of that name does it in WGSL.
//!
//! docs/concepts/score.md says what a score sees and what it does not.

pub mod clear;
pub mod companion;
pub mod constants;
pub mod display;
pub mod error;
pub mod fast;
pub mod gaze_trace;
pub mod geometry;
pub mod golden;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod named_displays;
pub mod picture;
pub mod pooling;
pub mod pyramid;
pub mod rules;
pub mod sensitivity;
pub mod temporal;
pub mod viewing;

pub use display::Display;
pub use error::ScoreError;
pub use fast::Judge;
pub use picture::ScorePicture;
pub use pooling::{FrameScore, Score, Zone};
pub use rules::{Mode, ScoreRules};
pub use viewing::Viewing;
