//! OpenEXR: which picture of a file is shown, and how.

pub mod head;
pub(crate) mod still;
