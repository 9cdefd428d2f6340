//! What senders and files say of a gaze, and when that was.

pub mod clock;
pub mod osc;
pub mod record;
pub mod route;
pub mod row;
pub mod stream;
pub mod trace;
pub mod tracker_table;
