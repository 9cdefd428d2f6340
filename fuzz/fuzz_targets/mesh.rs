//! Does any sequence of bytes, read as a warp mesh, panic?

#![no_main]

use foveal_scene::rig::read_any_mesh;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read_any_mesh(data);
});
