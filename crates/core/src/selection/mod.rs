//! Which units are worth their bytes?

pub mod greedy;
pub mod scheduler;
