//! Do any bytes, read as the tables of a scene's objects and of their names, panic or read back
//! otherwise?

#![no_main]

use foveal_core::content::scene::object_table::{read_names, read_objects, write_objects};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = read_names(data);
    if let Ok((objects, textures)) = read_objects(data) {
        let again = write_objects(&objects, &textures);
        let (back, _) = read_objects(&again).expect("it was just written");
        assert_eq!(back.len(), objects.len());
    }
});
