//! Does any text, read as a table of a measured eye, make one that sees what no eye can?
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::perception::measured::sensitivity::parse_anything(data);
});
