//! How pictures are cut into tiles, where cells lie, and which level each is shown at.

pub(crate) mod cells;
pub mod gather;
pub mod level_map;
pub(crate) mod neighbours;
pub mod places;
pub(crate) mod sphere_cell;
pub mod tile_grid;
