//! The device, how a pass is made of a shader, and how pictures come back.

pub(crate) mod device;
pub(crate) mod readback;
pub(crate) mod screen_pass;
