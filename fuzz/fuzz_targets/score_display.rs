//! Does any text, read as a display, panic or pass for one that gives no light or no angle?

#![no_main]

use foveal_eval::score::display::DisplayFile;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = core::str::from_utf8(data) else {
        return;
    };
    let Ok(file) = toml::from_str::<DisplayFile>(text) else {
        return;
    };
    if let Ok(display) = file.display() {
        display.assert_sound();
    }
});
