//! Which samples of a tile does the GPU hold?
//!
//! Copied back texel for texel, at the tile's own level: what a picture of the atlas is made of.

use crate::tiles::atlas::Planes;
use crate::{error::RenderError, gpu::device::Gpu};
use foveal_core::view::picture::{Picture, plane_size};
use std::sync::mpsc::channel;

/// A rectangle of one layer of a texture.
struct Region {
    at: [u32; 2],
    layer: u32,
    size: [u32; 2],
}

/// The samples of the tile whose first luma texel is at column, row and layer `texel`, `size` luma
/// pixels large; blocks until the GPU is done.
pub(crate) fn read_planes(
    gpu: &Gpu,
    planes: &Planes,
    [x, y, layer]: [u32; 3],
    size: [u32; 2],
) -> Result<Picture, RenderError> {
    let region = |shrink: u32, size| Region {
        at: [x / shrink, y / shrink],
        layer,
        size,
    };
    let [width, height] = size;
    let luma = read_texels(gpu, &planes.luma, &region(1, size))?;
    let half = plane_size(width, height, 1);
    let chroma = read_texels(gpu, &planes.chroma, &region(2, half))?;
    let every_other = |first: usize| chroma.iter().skip(first).step_by(2).copied().collect();
    Ok(Picture {
        width,
        height,
        planes: [luma, every_other(0), every_other(1)],
    })
}

fn read_texels(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    region: &Region,
) -> Result<Vec<u8>, RenderError> {
    let lost = |reason: String| RenderError::ReadBack(reason);
    let [width, height] = region.size;
    let texel = texture.format().block_copy_size(None).unwrap_or(1);
    let bytes_per_row = (width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back a tile"),
        size: u64::from(bytes_per_row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    copy(gpu, texture, region, &buffer, bytes_per_row);
    let (tell, told) = channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // Nobody listens any more only when the poll below failed.
        let _ = tell.send(result);
    });
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|reason| lost(reason.to_string()))?;
    told.recv()
        .map_err(|_| lost("the copy was dropped".to_owned()))?
        .map_err(|reason| lost(reason.to_string()))?;
    let mapped = buffer
        .get_mapped_range(..)
        .map_err(|reason| lost(reason.to_string()))?;
    let rows = mapped.chunks_exact(bytes_per_row as usize);
    let texels = rows
        .flat_map(|row| &row[..(width * texel) as usize])
        .copied();
    Ok(texels.collect())
}

fn copy(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    region: &Region,
    buffer: &wgpu::Buffer,
    bytes_per_row: u32,
) {
    let [x, y] = region.at;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d {
                x,
                y,
                z: region.layer,
            },
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(bytes_per_row),
                rows_per_image: None,
            },
        },
        wgpu::Extent3d {
            width: region.size[0],
            height: region.size[1],
            depth_or_array_layers: 1,
        },
    );
    gpu.queue.submit([encoder.finish()]);
}
