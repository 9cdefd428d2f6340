//! A pack from and to a file, and what an unfinished one is good for.

mod calibrated_copy;
pub mod content_tag;
pub mod damage;
pub(crate) mod journal_file;
pub mod name_claim;
mod open_pack;
#[allow(
    clippy::module_inception,
    reason = "the folder of packs holds one type of that name"
)]
pub mod pack;
pub mod pack_file;
pub(crate) mod pack_writer;
pub mod scene_file;

pub use calibrated_copy::write_calibrated;
