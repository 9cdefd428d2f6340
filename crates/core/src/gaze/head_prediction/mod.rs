//! Where do the eyes look in the head, when only the head is seen?
//!
//! Gaze runs ahead of a turning head. The product's predictor is [`saturating`], made one viewer's
//! own by [`adaptive`]; [`sgaze`] and [`lu_2020`] are published baselines it is judged against.

pub mod adaptive;
mod gaze_in_head;
pub mod lu_2020;
mod motion;
pub mod motion_from_poses;
pub mod saturating;
pub mod sgaze;

pub use gaze_in_head::GazeInHead;
pub use motion::{HeadMotion, SgazeMotion};
