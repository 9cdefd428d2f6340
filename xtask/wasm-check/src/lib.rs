//! Does a browser select what this machine selects, and do sessions there do the same? Hashes of
//! scripted runs, for wasm hosts.
//!
//! `cargo xtask wasm` builds this library for wasm32, calls it under Node and compares the numbers
//! with what the program `selection-hash` prints.

#[path = "../../../crates/core/tests/any_order/mod.rs"]
mod any_order;

use any_order::Stage;
use foveal_core::content::demand::Content;
use foveal_core::content::policy::PolicyConfig;
use foveal_core::content::scene::demand::why_not;
use foveal_core::content::scene::scripted::scripted_scene;
use foveal_core::content::scripted::SCRIPTED_POLICIES;
use foveal_core::session::log::{SessionLogPart, sha256_hex};
use foveal_core::session::scripted::{scripted_flight, scripted_sessions};
use std::sync::Arc;

/// Schedules of sessions that are run.
const SCHEDULES: u64 = 100;

/// The first 64 bits of the SHA-256 of the scripted sessions' logs, over pictures and through a
/// scene.
///
/// # Panics
/// The scripted scene is none.
#[unsafe(no_mangle)]
#[allow(
    unsafe_code,
    reason = "an exported name is the whole interface to a wasm host"
)]
pub extern "C" fn selection_hash() -> u64 {
    let logs: String = scripted_sessions()
        .iter()
        .chain(&through_a_scene())
        .map(|session| session.write())
        .collect();
    hash_of(&logs)
}

/// What every policy of scenes chooses on a flight round one.
fn through_a_scene() -> Vec<SessionLogPart> {
    let scene = match scripted_scene() {
        Ok(scene) => Arc::new(scene),
        Err(error) => panic!("{error}"),
    };
    let bounds = scene.bounds();
    let policies = SCRIPTED_POLICIES.into_iter();
    let policies = policies.filter(|policy| why_not(*policy).is_none());
    let flight = |policy| {
        let content = Arc::clone(&scene) as Arc<dyn Content>;
        let sphere = (bounds.centre, bounds.radius);
        scripted_flight(content, sphere, PolicyConfig::new(policy))
    };
    policies.map(flight).collect()
}

/// The first 64 bits of the SHA-256 of what sessions do whose wishes are fulfilled in any order;
/// what must hold of them is checked on the way.
///
/// # Panics
/// Something that must hold did not.
#[unsafe(no_mangle)]
#[allow(
    unsafe_code,
    reason = "an exported name is the whole interface to a wasm host"
)]
pub extern "C" fn session_hash() -> u64 {
    let stage = match Stage::new() {
        Ok(stage) => stage,
        Err(error) => panic!("{error}"),
    };
    let runs: String = (0..SCHEDULES)
        .map(|seed| format!("{:016x}", stage.run(seed)))
        .collect();
    hash_of(&runs)
}

fn hash_of(text: &str) -> u64 {
    u64::from_str_radix(&sha256_hex(text.as_bytes())[..16], 16).unwrap_or_default()
}
