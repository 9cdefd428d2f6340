//! Does any sequence of bytes, read as a unit of a mesh, panic or give numbers out of range?

#![no_main]

#[path = "../../crates/core/tests/mesh_units/mod.rs"]
mod mesh_units;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| mesh_units::parse_anything(data));
