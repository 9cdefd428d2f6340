//! What can be sent and shown: pictures, tiles, units and the pack that holds them.

pub mod codec;
pub mod picture;
