//! Where does the eye look? Samples, recorded traces, network records and a simulated scan path.

pub mod clock;
pub mod head;
pub mod loss;
pub mod osc;
pub mod record;
pub mod row;
pub mod sample;
pub mod scan;
pub mod stream;
pub mod trace;
