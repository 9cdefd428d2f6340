//! How true are detectors and predictors of gaze, against recordings of real eyes?

pub mod angle_statistics;
pub mod delay_protocol;
pub mod events;
pub mod filter;
pub mod head_fit;
pub mod head_from_trace;
pub mod head_protocol;
pub mod head_recording;
pub mod labelled;
pub mod landing;
pub mod recording;
pub mod saccade;
pub mod synthetic;
#[cfg(test)]
mod synthetic_viewer;
pub mod trace_from_head;
pub mod velocity_rules;
