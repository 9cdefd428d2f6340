//! What an eye resolves and sees, as somebody measured it.

pub mod acuity;
pub mod rows;
pub mod sensitivity;
