//! How true are detectors and predictors of gaze, against recordings of real eyes?

pub mod angle_statistics;
pub mod delay_protocol;
pub mod head_fit;
pub mod head_protocol;
pub mod head_recording;
#[cfg(test)]
mod synthetic_viewer;
