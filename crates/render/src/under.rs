//! What is drawn in front of what?

use crate::image::RgbaImage;

/// The picture that the assets before one show, which that one is drawn over.
#[derive(Clone, Debug, Default)]
pub struct Under {
    /// Where a GPU draws.
    pub texture: Option<wgpu::Texture>,
    /// Where the twin does.
    pub image: Option<RgbaImage>,
}
