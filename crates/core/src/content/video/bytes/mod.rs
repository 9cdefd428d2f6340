//! How video lies in a pack: its description, the numbers of its units, its side tables.

pub mod build;
pub mod calibration_table;
pub mod chunk;
pub mod codec;
pub mod cue_table;
pub mod description;
pub mod frame_times;
pub mod key_frame;
mod needs;
pub mod pack;
pub mod rate;
pub mod signatures;
#[cfg(any(test, feature = "testing"))]
pub mod small_pack;
pub mod sound;
#[cfg(test)]
mod tests;
