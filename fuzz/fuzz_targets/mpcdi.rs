//! Does any sequence of bytes, read as an MPCDI with its maps, panic?

#![no_main]

use foveal_scene::rig::read_any_mpcdi;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read_any_mpcdi(data);
});
