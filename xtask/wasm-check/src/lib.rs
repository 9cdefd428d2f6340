//! Does a browser select what this machine selects? The hash of a scripted run, for wasm hosts.
//!
//! `cargo xtask wasm` builds this library for wasm32, calls it under Node and compares the number
//! with what the program `selection-hash` prints.

use foveal_core::session::log::sha256_hex;
use foveal_core::session::scripted::scripted_sessions;

/// The first 64 bits of the SHA-256 of the scripted sessions' logs.
#[unsafe(no_mangle)]
#[allow(
    unsafe_code,
    reason = "an exported name is the whole interface to a wasm host"
)]
pub extern "C" fn selection_hash() -> u64 {
    let logs: String = scripted_sessions()
        .iter()
        .map(|session| session.write())
        .collect();
    u64::from_str_radix(&sha256_hex(logs.as_bytes())[..16], 16).unwrap_or_default()
}
