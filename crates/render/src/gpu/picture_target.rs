//! What is drawn on?

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::textures::texture_array;

/// Format of every picture drawn.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Format of the mask that says which pixels a pass has drawn already.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

/// What passes draw on: a picture, and which of its pixels are drawn already.
pub(crate) struct PictureTarget {
    pub(crate) picture: wgpu::Texture,
    views: [wgpu::TextureView; 2],
}

impl PictureTarget {
    /// A target of `size` pixels, each at least 1.
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        Self::with_mips(gpu, size, 1)
    }

    /// A target whose picture has room for so many halves, itself the first.
    pub(crate) fn with_mips(gpu: &Gpu, size: [u32; 2], mips: u32) -> Self {
        let texture = |format, usage, mips| {
            let usage = usage | wgpu::TextureUsages::RENDER_ATTACHMENT;
            let [width, height] = size;
            texture_array(
                &gpu.device,
                "picture",
                [width, height, 1, mips],
                format,
                usage,
            )
        };
        let read = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        let picture = texture(FORMAT, read, mips);
        let depth = texture(DEPTH_FORMAT, wgpu::TextureUsages::empty(), 1);
        let drawn_on = wgpu::TextureViewDescriptor {
            mip_level_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        };
        let views = [&picture, &depth].map(|t| t.create_view(&drawn_on));
        Self { picture, views }
    }

    /// What is drawn on, and read by passes after it.
    pub(crate) fn picture_view(&self) -> &wgpu::TextureView {
        &self.views[0]
    }

    /// All of it.
    pub(crate) fn whole(&self) -> Area<'_> {
        let [picture, depth] = &self.views;
        Area {
            picture,
            depth: Some(depth),
            within: None,
        }
    }

    /// Left, top, width and height of it.
    pub(crate) fn within(&self, within: [u32; 4]) -> Area<'_> {
        Area {
            within: Some(within),
            ..self.whole()
        }
    }

    /// Makes the target `size` pixels, at least 1 on a side; refuses what the device cannot draw.
    pub(crate) fn fit(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
        let size = size.map(|side| side.max(1));
        check_size(gpu, size)?;
        if self.size() != size {
            *self = Self::new(gpu, size);
        }
        Ok(())
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.picture.width(), self.picture.height()]
    }
}

/// Refuses a size that the device cannot draw.
pub(crate) fn check_size(gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
    let (side, most) = (
        size[0].max(size[1]),
        gpu.device.limits().max_texture_dimension_2d,
    );
    let what = "the picture";
    match side > most {
        true => Err(RenderError::TooLarge { what, side, most }),
        false => Ok(()),
    }
}

/// Which pixels of a picture a pass draws; one that replaces the picture leaves the others black.
#[derive(Clone, Copy)]
pub(crate) struct Area<'a> {
    pub(crate) picture: &'a wgpu::TextureView,
    /// Which pixels are drawn already: what a pass of several steps needs.
    pub(crate) depth: Option<&'a wgpu::TextureView>,
    /// Left, top, width, height; all of it where there are none.
    pub(crate) within: Option<[u32; 4]>,
}

impl<'a> Area<'a> {
    /// All of a view of one mip of a picture, for passes of one step.
    pub(crate) fn of_view(picture: &'a wgpu::TextureView) -> Self {
        Self {
            picture,
            depth: None,
            within: None,
        }
    }
}
