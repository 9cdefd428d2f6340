//! What can be shown: kinds of content, in units that selection weighs.

mod bits;
pub mod demand;
pub mod head;
pub mod images;
pub mod mesh;
pub mod opened;
pub mod payload;
pub mod points;
pub mod policy;
pub mod scene;
pub mod scripted;
mod strict_json;
pub mod unit;
pub mod video;
