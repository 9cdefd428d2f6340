//! Where does a film end, and what lies behind it?

pub mod animation_end;
pub mod behind_end;
pub mod cut_short;
pub(crate) mod joints;
pub(crate) mod other_file;
