//! Does any sequence of bytes, read as a gaze trace, panic or allocate without bound?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::gaze::read::trace::parse_anything(data);
});
