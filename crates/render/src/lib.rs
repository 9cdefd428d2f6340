//! Resident units in, pictures out: the GPU side of Foveal, on wgpu, native and in the browser.
//!
//! A caller opens a [`Gpu`] and makes a [`Drawer`] for what a session plays: it receives decoded
//! units and draws views. Tiles of video lie in a [`TileStore`] that a [`Renderer`] draws from; all
//! kinds of units of a 3D scene are layers of one [`SceneLayer`]. Every pass is one WGSL file in
//! `shaders/` with a CPU twin of the same name in [`twin`], which also draws without a GPU.

#![forbid(unsafe_code)]

mod asset_drawer;
mod draw_device;
mod drawer;
mod drawn_scene;
mod error;
pub mod gpu;
pub mod idle;
mod image;
pub mod importance;
mod kinds;
pub mod meshes;
mod pages;
pub mod params;
pub mod points;
pub mod scene;
mod scene_drawer;
pub mod shaders;
mod tiles;
pub mod twin;
mod under;
pub mod warp;

pub use crate::gpu::device::Gpu;
pub use crate::gpu::readback::ReadBack;
pub use crate::tiles::blur::RadialBlur;
pub use crate::tiles::drawer::{TileDrawer, TileStyle};
pub use crate::tiles::frame::Renderer;
pub use crate::tiles::halving::HalvedBy;
pub use crate::tiles::sampling::{mask_shape, sample_count};
pub use crate::tiles::sparse::Interpolation;
pub use crate::tiles::store::TileStore;
pub use crate::tiles::textures::{TextureRenderer, texture_bytes};
pub use draw_device::{DrawDevice, DrawnPicture};
pub use drawer::Drawer;
pub use drawn_scene::DrawnScene;
pub use error::RenderError;
pub use image::RgbaImage;
pub use params::Overlay;
pub use scene::coming::{Coming, Refiners};
pub use scene::layer::SceneLayer;
pub use scene::params::{Culling, SceneStyle};
pub use scene_drawer::SceneDrawer;
pub use under::Under;
