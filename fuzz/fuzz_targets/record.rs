//! Does any sequence of bytes, read as network records of a gaze, panic or give what is no gaze?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::gaze::read::stream::stream_anything(data);
});
