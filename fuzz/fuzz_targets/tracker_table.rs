//! Does any text, taken for the table of a tracker, make a trace that is none?
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = foveal_core::gaze::read::tracker_table::parse_anything(data);
});
