//! What surrounds a face? The twins of the shaders that say it, one a projection.

pub(crate) mod cube;
pub(crate) mod equirect;
pub(crate) mod plane;
