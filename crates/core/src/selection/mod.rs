//! Which units are worth their bytes?

pub mod chooser;
pub mod greedy;
pub mod refine;
