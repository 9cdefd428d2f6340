//! Does any sequence of bytes, read as a route through a scene, panic or allocate without bound?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::gaze::read::route::parse_anything(data);
});
