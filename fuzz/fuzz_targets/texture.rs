//! Does any sequence of bytes, read as the picture of a texture, panic or give another size?

#![no_main]

use foveal_scene::read::read_any_picture;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read_any_picture(data);
});
