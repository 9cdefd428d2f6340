//! Where does the eye look? Samples, recorded traces and a simulated scan path.

pub mod head;
pub mod sample;
pub mod scan;
pub mod trace;
