//! What one viewer is shown as time goes on, and the log that replays it.

pub mod actions;
pub mod bounds;
pub mod budget;
mod client_memory;
pub mod decoder;
pub mod figures;
pub mod log;
pub mod log_of_parts;
pub mod media_clock;
mod policy_run;
mod recorded;
pub mod scripted;
#[allow(
    clippy::module_inception,
    reason = "the room of sessions holds one type of that name"
)]
pub mod session;
pub mod unit_states;
pub mod viewer;
