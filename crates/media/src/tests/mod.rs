//! Tests that need several rooms, and the scenes that they look at.

mod broken;
mod codec;
mod decode_pool;
mod format;
mod input;
mod layout;
mod pack;
mod resume;
pub(crate) mod scenes;
mod side_table;
mod sound;
