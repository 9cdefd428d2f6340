//! What can the eye resolve?

pub mod acuity;
