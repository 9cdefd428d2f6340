//! Does any text, read as the table of a tracker, make an invalid trace?
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::gaze::read::tracker_table::parse_anything(data);
});
