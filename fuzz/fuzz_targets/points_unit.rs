//! Does any sequence of bytes, read as a unit of points, panic or give points outside its cube?

#![no_main]

#[path = "../../crates/core/tests/point_units/mod.rs"]
mod point_units;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| point_units::parse_anything(data));
