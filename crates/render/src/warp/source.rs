//! How does the source lie on the GPU?

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::textures::{texture_array, write_texels};
use crate::image::RgbaImage;

/// Codes are stored, linear light is filtered.
pub(crate) const SOURCE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A source with its coarser levels, if it has any. The finest is written again for every frame.
pub struct SourceTexture {
    pub(crate) texture: wgpu::Texture,
    pub(crate) levels: Vec<wgpu::TextureView>,
}

/// Levels of a source, down to one texel.
#[must_use]
pub fn levels_of(size: [u32; 2]) -> u32 {
    size[0].max(size[1]).max(1).ilog2() + 1
}

impl SourceTexture {
    /// An empty source of `size` texels, with coarser levels where some panel minifies it.
    ///
    /// # Errors
    /// [`RenderError::TooLarge`] when the device holds no such texture, or
    /// [`RenderError::OutOfMemory`] when its memory has no room for it.
    pub fn new(gpu: &Gpu, size: [u32; 2], has_levels: bool) -> Result<Self, RenderError> {
        let most = gpu.device.limits().max_texture_dimension_2d;
        let side = size[0].max(size[1]);
        if side > most {
            let what = "the source";
            return Err(RenderError::TooLarge { what, side, most });
        }
        let count = if has_levels { levels_of(size) } else { 1 };
        let bytes = 4 * u64::from(size[0]) * u64::from(size[1]) * 4 / 3;
        let texture = gpu.roomed(("the source", bytes), |device| {
            let [width, height] = size.map(|side| side.max(1));
            let usage = wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::RENDER_ATTACHMENT;
            texture_array(
                device,
                "source",
                [width, height, 1, count],
                SOURCE_FORMAT,
                usage,
            )
        })?;
        let level = |base_mip_level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level,
                mip_level_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        let levels = (0..count).map(level).collect();
        Ok(Self { texture, levels })
    }

    /// Columns and rows of the finest level.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.texture.width(), self.texture.height()]
    }

    /// Replaces the finest level; the coarser ones follow when panels are drawn.
    ///
    /// # Errors
    /// [`RenderError::Misfit`] when the picture has another size.
    pub fn write(&self, gpu: &Gpu, picture: &RgbaImage) -> Result<(), RenderError> {
        if picture.size != self.size() {
            return Err(RenderError::Misfit {
                what: "a frame of the source".to_owned(),
                expected: format!("{:?} pixels", self.size()),
                found: format!("{:?} pixels", picture.size),
            });
        }
        write_texels(gpu, &self.texture, [0; 4], picture.size, &picture.pixels);
        Ok(())
    }
}
