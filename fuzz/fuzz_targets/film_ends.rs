//! Do any bytes make the walks through the parts of films and animations panic, or not end, as they
//! look for their end, for another film behind it, and for what is wrong in the head?

#![no_main]

use std::io::Cursor;

use foveal_media::read::film::ends::animation_end::why_cut;
use foveal_media::read::film::ends::behind_end::second_film;
use foveal_media::read::film::clusters::clusters;
use foveal_media::read::film::corrected::corrections::corrections;
use foveal_media::read::film::ends::cut_short::read_any_end;
use foveal_media::read::film::corrected::mp4_says::notes;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let found = clusters(Cursor::new(data));
    assert!(found.all <= data.len() as u64);
    let _ = why_cut(&mut Cursor::new(data));
    read_any_end(data);
    let _ = second_film(&mut Cursor::new(data));
    let _ = corrections(&mut Cursor::new(data));
    let _ = notes(&mut Cursor::new(data));
});
