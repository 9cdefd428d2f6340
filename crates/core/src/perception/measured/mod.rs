//! What an eye resolves and sees, as measured.

pub mod acuity;
pub mod rows;
pub mod sensitivity;
