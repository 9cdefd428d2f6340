//! How good was it? Judges what the pipeline did; nothing here feeds it.

pub mod bench_cases;
pub mod disc_error;
pub mod fft_importance;
pub mod gaze;
pub mod importance_bench;
pub mod path_bench;
pub mod score;
pub mod timing;
