//! How good was it? Judges what the pipeline did; nothing here feeds it.

pub mod fft_importance;
pub mod gaze;
pub mod importance_bench;
