//! In which pieces is a picture worked on?

/// Rows that one thread works on at a time.
pub(super) const ROWS: usize = 16;
