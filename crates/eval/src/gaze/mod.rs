//! How true are detectors and predictors of gaze, against recordings of real eyes?

pub mod events;
pub mod filter;
pub mod labelled;
pub mod landing;
pub mod recording;
pub mod saccade;
pub mod synthetic;
