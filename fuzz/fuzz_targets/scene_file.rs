//! Does any sequence of bytes, read as a scene file, panic?

#![no_main]

use foveal_scene::read::read_any_arrangement;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read_any_arrangement(data);
});
