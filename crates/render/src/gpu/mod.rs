//! The device, how passes are built, recorded and timed, and how results come back.

pub(crate) mod arena;
pub(crate) mod bindings;
pub mod buffers;
pub mod compute;
pub(crate) mod device;
pub(crate) mod picture_target;
pub(crate) mod pipeline;
pub(crate) mod pool;
pub mod readback;
pub mod room;
pub(crate) mod screen_pass;
pub(crate) mod textures;
pub mod timer;
