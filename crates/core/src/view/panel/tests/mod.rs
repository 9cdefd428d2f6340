//! Do panels look where Strege 2009 and an independent script say, and is the source placed well?

mod goldens;
mod properties;
pub(crate) mod sets;
