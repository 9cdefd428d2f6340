//! What can be sent and shown: pictures, tiles, units and the pack that holds them.

pub mod codec;
pub mod cues;
pub mod frame_times;
pub mod gather;
pub mod key_frame;
pub mod order;
pub mod pack;
pub mod picture;
pub mod rate;
pub mod signature;
pub mod sound;
pub mod tile_grid;
pub mod unit;
