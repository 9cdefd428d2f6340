//! What can be shown: kinds of content, in units that selection weighs.

pub mod asked;
pub mod calibration;
pub mod policy;
pub mod video;
