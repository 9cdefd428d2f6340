//! Do any bytes in an MP4 file make the search for broken boxes panic, or find one outside it?

#![no_main]

use std::io::Cursor;

use foveal_media::surround::spherical_boxes::broken_boxes;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    for broken in broken_boxes(&mut Cursor::new(data)) {
        assert!(broken.at + 4 <= data.len() as u64);
    }
});
