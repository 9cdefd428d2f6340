//! Does any sequence of bytes, read as a recording of eyes and head, panic or give what is none?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = foveal_eval::gaze::head_recording::parse_anything(data);
});
