//! What is a scene drawn on?

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::{FORMAT, check_size};
use crate::gpu::textures::texture_array;
use crate::scene::phase::{DEPTH_FORMAT, Go, Phase, UNITS_FORMAT};

/// Stands for no unit in an image of units.
const NO_UNIT: f64 = u32::MAX as f64;
/// Bytes of a pixel: its colour or unit, and its depth.
const PIXEL_BYTES: u64 = 8;

/// An image of colours or of units, and how near what is drawn in each pixel is.
pub(crate) struct SceneTarget {
    phase: Phase,
    image: wgpu::Texture,
    depth: wgpu::Texture,
}

impl SceneTarget {
    /// A target of one pixel for pictures of this.
    pub(crate) fn new(gpu: &Gpu, phase: Phase) -> Self {
        Self::of_size(gpu, phase, [1, 1])
    }

    fn of_size(gpu: &Gpu, phase: Phase, [width, height]: [u32; 2]) -> Self {
        let attached =
            wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let copied = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST;
        let texture = |label, format, usage| {
            texture_array(&gpu.device, label, [width, height, 1, 1], format, usage)
        };
        let image = match phase {
            Phase::Opaque | Phase::Transparent => texture("picture", FORMAT, attached | copied),
            Phase::Ids => texture("units of a scene", UNITS_FORMAT, attached | copied),
        };
        Self {
            phase,
            image,
            depth: texture("depths of a scene", DEPTH_FORMAT, attached),
        }
    }

    /// Makes it `size` pixels, at least 1 on a side.
    ///
    /// # Errors
    /// The device draws no picture that is so large.
    pub(crate) fn fit(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
        let size = size.map(|side| side.max(1));
        check_size(gpu, size)?;
        if self.size() != size {
            *self = Self::of_size(gpu, self.phase, size);
        }
        Ok(())
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.image.width(), self.image.height()]
    }

    /// Bytes of GPU memory of a target of this size.
    pub(crate) fn bytes_of(size: [u32; 2]) -> u64 {
        size.map(|side| u64::from(side.max(1)))
            .iter()
            .product::<u64>()
            * PIXEL_BYTES
    }

    /// The colours or units.
    pub(crate) fn image(&self) -> &wgpu::Texture {
        &self.image
    }

    /// The same, to be drawn on.
    pub(crate) fn image_view(&self) -> wgpu::TextureView {
        self.image.create_view(&Default::default())
    }

    /// The depths.
    pub(crate) fn depth_view(&self) -> wgpu::TextureView {
        self.depth.create_view(&Default::default())
    }

    /// Begins a go over all of it. Pixels have these codes where nothing stands, or show what is
    /// `under` the scene; the second go draws into what the first left.
    pub(crate) fn begin<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        go: Go,
        background: [u8; 4],
        under: Option<&wgpu::Texture>,
    ) -> wgpu::RenderPass<'a> {
        let is_begun = go == Go::Second;
        if let Some(under) = under.filter(|_| !is_begun) {
            let [from, to] = [under, &self.image].map(wgpu::Texture::as_image_copy);
            encoder.copy_texture_to_texture(from, to, self.image.size());
        }
        let clear = match self.phase {
            Phase::Opaque | Phase::Transparent => background.map(|it| f64::from(it) / 255.0),
            Phase::Ids => [NO_UNIT; 4],
        };
        let [r, g, b, a] = clear;
        let colour = wgpu::Color { r, g, b, a };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.image_view(),
                depth_slice: None,
                resolve_target: None,
                ops: begun(is_begun || under.is_some(), colour),
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth_view(),
                depth_ops: Some(begun(is_begun, 0.0)),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        })
    }
}

/// How a go begins: with what is there, or with a value everywhere.
fn begun<V>(is_there: bool, value: V) -> wgpu::Operations<V> {
    wgpu::Operations {
        load: match is_there {
            true => wgpu::LoadOp::Load,
            false => wgpu::LoadOp::Clear(value),
        },
        store: wgpu::StoreOp::Store,
    }
}
