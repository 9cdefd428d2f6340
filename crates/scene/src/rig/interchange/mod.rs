//! How are rigs exchanged with other programs?
//!
//! [`mpcdi`] reads VESA's MPCDI, [`mesh`] Bourke's warp meshes, [`projectors`] what projectors
//! light of a wall; [`written_mpcdi`] and [`written_toml`] write.

mod archive;
mod foreign_text;
pub(super) mod mesh;
pub(super) mod mpcdi;
mod mpcdi_files;
mod mpcdi_region;
pub(super) mod projectors;
mod space_map;
mod warp_map;
pub(super) mod written_mpcdi;
pub(super) mod written_toml;
mod xml;

/// A number without what sums have rounded in its last digits: 13 digits, and none of what is
/// nothing.
fn neat(number: f64) -> f64 {
    let short = format!("{number:.12e}").parse().unwrap_or(number);
    if short.abs() < 1e-13 { 0.0 } else { short }
}
