//! How do other programs tell which displays there are, and how are they told?
//!
//! [`mpcdi`] reads VESA's MPCDI, [`mesh`] Bourke's warp meshes; [`written_mpcdi`] and
//! [`written_toml`] write.

mod archive;
pub(super) mod mesh;
pub(super) mod mpcdi;
mod mpcdi_files;
mod space_map;
mod warp_map;
pub(super) mod written_mpcdi;
pub(super) mod written_toml;
mod xml;
