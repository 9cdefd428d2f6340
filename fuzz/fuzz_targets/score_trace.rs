//! Does any sequence of bytes, read as places in a picture by frame, panic or read back otherwise?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    foveal_eval::score::gaze_trace::parse_anything(data);
});
