//! Pictures on surfaces, in pages at several levels.

pub mod halving;
pub mod payload;
pub mod picture;
pub mod shape;
pub mod wrap;
