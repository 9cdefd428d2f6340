//! Where does the eye look? Samples, recorded traces, a simulated scan path, and what the eye does.

pub mod head;
pub mod landing;
pub mod main_sequence;
pub mod one_euro;
pub mod saccade;
pub mod sample;
pub mod scan;
pub mod trace;
