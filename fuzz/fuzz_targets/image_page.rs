//! Does any sequence of bytes, read as a page of a texture, panic or give another size?

#![no_main]

#[path = "../../crates/core/tests/image_pages/mod.rs"]
mod image_pages;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    image_pages::parse_anything(data);
});
