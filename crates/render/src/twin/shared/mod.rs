//! What do the passes share? The twins of `shaders/shared/`, and what WGSL has itself.

pub(crate) mod colour;
pub(crate) mod footprint;
pub(crate) mod lattice;
pub(crate) mod mapping;
pub(crate) mod pages;
pub(crate) mod picture;
pub(crate) mod ramp;
pub(crate) mod raster;
pub(crate) mod scene;
pub(crate) mod screen;
pub(crate) mod surroundings;
pub(crate) mod tiles;
pub(crate) mod wgsl;
pub(crate) mod widened;

pub(crate) use surroundings::{cube, equirect, plane};
