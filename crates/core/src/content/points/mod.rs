//! Point clouds: points in units, each of which adds points to a cube of space.

pub mod cloud;
mod cloud_point;
mod curve;
pub mod cut;
mod lengths;
pub mod payload;
pub mod whole;
