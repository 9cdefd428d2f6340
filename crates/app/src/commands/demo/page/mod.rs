//! How does a report read?

pub(super) mod part;
pub(super) mod report;
