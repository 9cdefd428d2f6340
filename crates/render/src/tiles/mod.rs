//! Tiles on the device: which are there, in which texture, how they become a picture.

pub(crate) mod atlas;
pub(crate) mod atlas_shape;
pub(crate) mod blur;
pub(crate) mod drawer;
pub(crate) mod frame;
pub(crate) mod halving;
pub(crate) mod level_map;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) mod read_tile;
pub(crate) mod reduce;
pub(crate) mod samples;
pub(crate) mod sampling;
pub(crate) mod sparse;
pub(crate) mod store;
pub(crate) mod textures;
pub(crate) mod tile_pass;
