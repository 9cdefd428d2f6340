//! Does any sequence of bytes, read as a labelled recording, panic or give what is none?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = foveal_eval::gaze::labelled::parse_anything(data);
});
