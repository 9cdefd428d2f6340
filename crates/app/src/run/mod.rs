//! The packs and sources that are played, and how they are opened.

pub(crate) mod calibrate;
pub(crate) mod in_parallel;
pub(crate) mod kept_pack;
pub(crate) mod loss;
pub(crate) mod mesh_file;
mod not_the_file;
pub(crate) mod open_player;
pub(crate) mod optics;
pub(crate) mod other_input;
pub(crate) mod pack_place;
pub(crate) mod quantisers;
pub(crate) mod run_folder;
pub(crate) mod scene_clip;
pub(crate) mod shown_frames;
pub(crate) mod source_frames;
pub(crate) mod timed;
