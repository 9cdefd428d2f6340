//! How are textures made, and their texels written?

use crate::gpu::device::Gpu;
use std::ops::Range;

/// A texture array of so many columns, rows, layers and mips, all at least 1.
pub(crate) fn texture_array(
    device: &wgpu::Device,
    label: &'static str,
    [width, height, depth_or_array_layers, mip_level_count]: [u32; 4],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers,
        },
        mip_level_count,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// The view of all layers of some mips of a texture, as an array also where there is one layer.
pub(crate) fn layers_of(texture: &wgpu::Texture, mips: Range<u32>) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        base_mip_level: mips.start,
        mip_level_count: Some(mips.end - mips.start),
        ..wgpu::TextureViewDescriptor::default()
    })
}

/// Texels of two channels: samples of `u` and `v` in turn.
pub(crate) fn paired(u: &[u8], v: &[u8]) -> Vec<u8> {
    let mut texels = vec![0; 2 * u.len()];
    for (texel, (u, v)) in texels.chunks_exact_mut(2).zip(u.iter().zip(v)) {
        texel.copy_from_slice(&[*u, *v]);
    }
    texels
}

/// Writes texels, row by row, to a column, row, layer and mip of a texture; `size` is their columns
/// and rows, at least 1.
pub(crate) fn write_texels(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    [x, y, z, mip_level]: [u32; 4],
    [width, height]: [u32; 2],
    bytes: &[u8],
) {
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d { x, y, z },
            aspect: wgpu::TextureAspect::All,
        },
        bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((bytes.len() / height as usize) as u32),
            rows_per_image: None,
        },
        wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
    );
}
