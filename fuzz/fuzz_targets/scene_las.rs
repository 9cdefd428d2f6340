//! Does any sequence of bytes, read as a LAS or LAZ file, panic or give what is no scene?

#![no_main]

use foveal_scene::read::{SceneFormat, read_anything};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read_anything(SceneFormat::Las, data);
});
