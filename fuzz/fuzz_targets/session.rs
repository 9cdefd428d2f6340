//! Does any sequence of bytes, read as a session log, panic or allocate without bound?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::session::log_of_parts::parse_anything(data);
});
