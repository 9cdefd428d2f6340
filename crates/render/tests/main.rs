//! Is what is drawn right, on the device and by its twin?
//!
//! One program for all of them: each would link the whole crate again.

// A test that cannot go on panics; one says what it measured.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

mod boxes;
mod common;
mod eye_blur;
mod golden;
mod hiding;
mod importance;
mod kastner;
#[path = "../../core/tests/looking/mod.rs"]
mod looking;
#[path = "../../core/tests/made_video/mod.rs"]
mod made_video;
mod meshes;
mod morphs;
#[path = "../../core/tests/boxes/mod.rs"]
mod octree_boxes;
mod optics;
mod points;
mod properties;
mod read_tile;
mod residency;
mod shaders;
mod staying;
mod textures;
mod twins;
mod two_assets;
mod warp;
