//! Which pictures are judged, and which unit has each of their pixels?

use crate::gpu::textures::{texture_array, write_texels};
use crate::{error::RenderError, gpu::device::Gpu, image::RgbaImage};

/// Format of level pictures: sRGB codes as they are.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const IDS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// An image of unit ids: for every pixel one below `units`, or
/// [`foveal_core::perception::importance::NO_UNIT`].
#[derive(Clone, Debug)]
pub struct UnitIds {
    /// One r32uint texel for every pixel, with `TEXTURE_BINDING`.
    pub texture: wgpu::Texture,
    /// How many units there are.
    pub units: usize,
}

impl UnitIds {
    /// Puts ids, row by row, on the GPU.
    ///
    /// # Errors
    /// When there are not `size` ids or the device has no texture of that size.
    pub fn upload(
        gpu: &Gpu,
        size: [u32; 2],
        ids: &[u32],
        units: usize,
    ) -> Result<Self, RenderError> {
        let bytes = bytemuck::cast_slice(ids);
        let texture = upload(gpu, "the image of unit ids", size, IDS_FORMAT, bytes)?;
        Ok(Self { texture, units })
    }
}

/// Puts a level picture on the GPU; its alpha does not count.
///
/// # Errors
/// When it has not its size's pixels or the device has no texture of that size.
pub fn upload_picture(gpu: &Gpu, picture: &RgbaImage) -> Result<wgpu::Texture, RenderError> {
    let (size, what) = (picture.size, "the level picture");
    upload(gpu, what, size, PICTURE_FORMAT, &picture.pixels)
}

fn upload(
    gpu: &Gpu,
    what: &'static str,
    size: [u32; 2],
    format: wgpu::TextureFormat,
    bytes: &[u8],
) -> Result<wgpu::Texture, RenderError> {
    let most = gpu.device.limits().max_texture_dimension_2d;
    let side = size[0].max(size[1]);
    if side > most {
        return Err(RenderError::TooLarge { what, side, most });
    }
    // Both formats have four bytes a pixel.
    let pixels = size[0] as usize * size[1] as usize;
    if bytes.len() != pixels * 4 || pixels == 0 {
        return Err(RenderError::Misfit {
            what: what.to_owned(),
            expected: format!("{} x {} pixels, at least one", size[0], size[1]),
            found: format!("{} pixels", bytes.len() / 4),
        });
    }
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = texture_array(&gpu.device, what, [size[0], size[1], 1, 1], format, usage);
    write_texels(gpu, &texture, [0; 4], size, bytes);
    Ok(texture)
}

/// Refuses a level picture that is not of `size` rgba8unorm pixels and bindable.
pub(super) fn check_picture(
    level: usize,
    texture: &wgpu::Texture,
    size: [u32; 2],
) -> Result<(), RenderError> {
    check(
        &format!("the picture of level {level}"),
        texture,
        size,
        PICTURE_FORMAT,
    )
}

/// Refuses an image of unit ids that is not of `size` r32uint pixels and bindable.
pub(super) fn check_ids(ids: &UnitIds, size: [u32; 2]) -> Result<(), RenderError> {
    check("the image of unit ids", &ids.texture, size, IDS_FORMAT)
}

fn check(
    what: &str,
    texture: &wgpu::Texture,
    size: [u32; 2],
    format: wgpu::TextureFormat,
) -> Result<(), RenderError> {
    let binding = wgpu::TextureUsages::TEXTURE_BINDING;
    let words = |size: [u32; 2], format, bound| {
        let bound = if bound { "bindable" } else { "not bindable" };
        format!("{} x {} of {format:?}, {bound}", size[0], size[1])
    };
    let found = (
        [texture.width(), texture.height()],
        texture.format(),
        texture.usage().contains(binding),
    );
    if found == (size, format, true) {
        return Ok(());
    }
    Err(RenderError::Misfit {
        what: what.to_owned(),
        expected: words(size, format, true),
        found: words(found.0, found.1, found.2),
    })
}
