//! What can the eye resolve, and what is a finer level worth to it?

pub mod acuity;
pub mod csf;
pub mod eye;
pub mod fast;
pub mod gain;
pub mod importance;
pub mod luminance;
pub mod parameters;
pub mod pyramid;
pub mod sensitivity;
pub mod sensitivity_table;
pub mod spread;
