//! Resident tiles in, pictures out: the GPU side of Foveal, on wgpu, native and in the browser.
//!
//! A caller opens a [`Gpu`], makes a [`Renderer`] for a tile grid, uploads decoded tiles into its
//! [`TileStore`] and draws views. Every pass is one WGSL file in `shaders/` with a CPU twin of the
//! same name in [`twin`], which also draws without a GPU.

#![forbid(unsafe_code)]

mod blur;
mod draw_device;
mod drawer;
mod error;
mod frame;
pub mod gpu;
mod image;
pub mod importance;
pub mod meshes;
mod pages;
pub mod params;
pub mod points;
pub mod shaders;
mod tiles;
pub mod twin;
pub mod warp;

pub use crate::gpu::device::Gpu;
pub use crate::gpu::readback::ReadBack;
pub use crate::tiles::drawer::TileStyle;
pub use crate::tiles::sampling::{mask_shape, sample_count};
pub use crate::tiles::sparse::Interpolation;
pub use crate::tiles::store::TileStore;
pub use crate::tiles::textures::{TextureRenderer, texture_bytes};
pub use blur::RadialBlur;
pub use draw_device::{DrawDevice, DrawnPicture};
pub use drawer::Drawer;
pub use error::RenderError;
pub use frame::Renderer;
pub use image::RgbaImage;
pub use meshes::{ComingUnit, Culling, SceneDrawer, SceneLayer, SceneStyle};
pub use pages::ComingPage;
pub use params::Overlay;
pub use points::ComingPoints;
