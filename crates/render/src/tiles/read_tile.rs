//! Which samples of a tile does the GPU hold?
//!
//! Copied back texel for texel, at the tile's own level: what a picture of the atlas is made of.

use crate::gpu::readback::BytesBack;
use crate::tiles::atlas::Planes;
use crate::{error::RenderError, gpu::device::Gpu};

/// A rectangle of one layer and mip of a texture.
struct Region {
    at: [u32; 2],
    layer: u32,
    mip: u32,
    size: [u32; 2],
}

/// Y, U and V in `mip` of the tile whose first luma texel in mip 0 is at column, row and layer
/// `texel`; `sizes` are columns and rows of luma and of chroma. Blocks until the GPU is done.
pub(crate) fn read_planes(
    gpu: &Gpu,
    planes: &Planes,
    ([x, y, layer], mip): ([u32; 3], u32),
    sizes: [[u32; 2]; 2],
) -> Result<[Vec<u8>; 3], RenderError> {
    let region = |plane: usize| Region {
        at: [x, y].map(|texel| (texel >> plane) >> mip),
        layer,
        mip,
        size: sizes[plane],
    };
    let mut encoder = gpu.encoder("a tile's samples");
    let copies = [
        TexelCopy::record(gpu, &mut encoder, &planes.luma, &region(0)),
        TexelCopy::record(gpu, &mut encoder, &planes.chroma, &region(1)),
    ];
    gpu.submit(encoder);
    let [luma, chroma] = copies.map(|copy| copy.texels(gpu));
    let (luma, chroma) = (luma?, chroma?);
    let every_other = |first: usize| chroma.iter().skip(first).step_by(2).copied().collect();
    Ok([luma, every_other(0), every_other(1)])
}

/// Texels on their way, and how their rows lie.
struct TexelCopy {
    buffer: wgpu::Buffer,
    bytes_per_row: u32,
    bytes_of_row: u32,
}

impl TexelCopy {
    fn record(
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
        region: &Region,
    ) -> Self {
        let [width, height] = region.size;
        let bytes_of_row = width * texture.format().block_copy_size(None).unwrap_or(1);
        let bytes_per_row = bytes_of_row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = BytesBack::buffer(gpu, u64::from(bytes_per_row) * u64::from(height));
        let [x, y] = region.at;
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: region.mip,
                origin: wgpu::Origin3d {
                    x,
                    y,
                    z: region.layer,
                },
                aspect: wgpu::TextureAspect::All,
            },
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(bytes_per_row),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
        );
        Self {
            buffer,
            bytes_per_row,
            bytes_of_row,
        }
    }

    /// Row after row without padding, once the copy is submitted; blocks.
    fn texels(self, gpu: &Gpu) -> Result<Vec<u8>, RenderError> {
        let bytes = BytesBack::map(self.buffer).wait(gpu)?;
        let rows = bytes.chunks_exact(self.bytes_per_row as usize);
        let texels = rows.flat_map(|row| &row[..self.bytes_of_row as usize]);
        Ok(texels.copied().collect())
    }
}
