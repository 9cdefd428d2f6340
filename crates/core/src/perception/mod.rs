//! What can the eye resolve, what is a finer level worth to it, and what draws it?

pub mod acuity;
pub mod csf;
pub mod eye;
pub mod fast;
pub mod footprints;
pub mod gain;
pub mod glance;
pub mod importance;
pub mod luminance;
pub mod measured;
pub mod measures;
pub mod moment;
pub mod parameters;
pub mod samples;
pub mod sensitivity;
pub mod sensitivity_table;
pub mod spread;
pub mod step_worth;
pub mod visible_loss;
