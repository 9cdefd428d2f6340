//! Pages of textures: where they lie on the GPU, and how shaders find them.

mod atlas;
pub(crate) mod layer;
pub(crate) mod table;
pub(crate) mod tail;
