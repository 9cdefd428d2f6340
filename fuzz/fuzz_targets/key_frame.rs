//! Does any access unit of any codec panic when it is asked whether it is a key frame?

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| foveal_core::content::video::bytes::key_frame::judge_anything(data));
