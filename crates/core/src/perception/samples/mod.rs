//! Which pixels round the gaze are samples, and which sample stands for a pixel.

pub mod blue_noise;
pub mod nearest_sample;
pub mod sample_mask;
