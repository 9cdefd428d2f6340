//! Resident tiles in, pictures out: the GPU side of Foveal, on wgpu, native and in the browser.
//!
//! A caller opens a [`Gpu`], makes a [`Renderer`] for a tile grid, uploads decoded tiles into its
//! [`TileStore`] and draws views. Every pass is one WGSL file in `shaders/` with a CPU twin of the
//! same name in [`twin`], which also draws without a GPU.

#![forbid(unsafe_code)]

mod atlas;
mod atlas_shape;
mod blur;
mod device;
mod error;
mod frame;
mod image;
pub mod importance;
mod level_map;
pub mod params;
mod passes;
#[cfg(not(target_arch = "wasm32"))]
mod read_tile;
mod readback;
mod reduce;
mod residency;
mod screen_pass;
pub mod shaders;
mod sparse;
mod textures;
pub mod twin;

pub use blur::RadialBlur;
pub use device::Gpu;
pub use error::RenderError;
pub use frame::Renderer;
pub use image::RgbaImage;
pub use params::Overlay;
pub use readback::ReadBack;
pub use residency::TileStore;
pub use sparse::Interpolation;
pub use textures::{TextureRenderer, texture_bytes};
