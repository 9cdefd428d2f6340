//! How results and failures are reported: text, JSON, pictures, plots.

pub(crate) mod called;
pub(crate) mod colour_ramp;
pub(crate) mod damage;
pub(crate) mod fault;
pub(crate) mod html;
mod names;
pub(crate) mod out_of_memory;
pub(crate) mod output;
pub(crate) mod picture_file;
pub(crate) mod plot;
pub(crate) mod remarks;
pub(crate) mod visible;
