//! Does any sequence of bytes, read as a pack, panic or allocate without bound?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::asset::pack::parse_anything(data);
});
