//! Point clouds: points in units, each of which adds points to a cube of space.

mod cloud_point;
mod curve;
pub mod cut;
mod lengths;
pub mod payload;
pub mod whole;
