//! Pages of textures: where they lie on the GPU, and how shaders find them.

mod atlas;
mod layer;
pub(crate) mod table;
pub(crate) mod tail;

pub use layer::ComingPage;
pub(crate) use layer::PageLayer;
