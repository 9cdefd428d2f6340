//! Do any bytes in the boxes of a HEIF picture make their reader panic, or take long?

#![no_main]

use std::io::Cursor;

use foveal_media::read::still::heif_boxes::read_heif;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = read_heif(&mut Cursor::new(data));
});
