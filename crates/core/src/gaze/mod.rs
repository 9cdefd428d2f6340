//! Where does the eye look? Samples, recorded traces, a simulated scan, and what the head says.

pub mod blend;
pub mod head;
pub mod head_prediction;
pub mod sample;
pub mod scan;
pub mod spread;
mod table;
pub mod trace;
