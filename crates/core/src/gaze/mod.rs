//! Where does the eye look, what does it do, and where will it look next?

pub mod blend;
pub mod head;
pub mod head_prediction;
pub mod landing;
pub mod loss;
pub mod main_sequence;
pub mod one_euro;
pub mod pointer;
pub mod read;
pub mod saccade;
pub mod sample;
pub mod scan;
pub mod spread;
mod table;
pub mod tracker;
