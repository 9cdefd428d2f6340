//! Does any sequence of bytes, read as a rig file or as a map that one names, panic?

#![no_main]

use foveal_scene::rig::{read_any_pfm, read_any_rig};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read_any_rig(data);
    read_any_pfm(data);
});
