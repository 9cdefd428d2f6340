//! Turns files into packs and packs into frames.

pub mod generate;
pub mod pyramid;
pub mod sphere;
