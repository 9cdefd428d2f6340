//! Which placement of a source needs the fewest pixels?

pub(super) mod curved;
mod hull;
pub(super) mod plane;
pub(super) mod samples;
