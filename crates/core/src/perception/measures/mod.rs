//! What is measured of pictures in advance: octaves, contrast, what draws the eye.

pub mod contrast;
pub mod cues;
pub mod luma_light;
pub mod pyramid;
pub mod saliency;
pub mod signature;
pub mod step_contrast;
