//! Where on the GPU do the samples of tiles lie?
//!
//! The *atlas* holds tiles of any level but the coarsest, in slots of one size; it grows by layers.
//! The *base* holds the coarsest level of every face, a layer a face. Chroma is one two-channel
//! texture of half the size: U and V are always read together, at one address.

use crate::{device::Gpu, error::RenderError, params::SlotShape, reduce::Samples};
use foveal_core::asset::tile_grid::{Tile, TileGrid};

/// A luma texture array and a chroma texture array of half its size.
pub(crate) struct Planes {
    pub(crate) luma: wgpu::Texture,
    pub(crate) chroma: wgpu::Texture,
}

impl Planes {
    fn new(gpu: &Gpu, what: &'static str, size: [u32; 2], depth: [u32; 2]) -> Self {
        let [layers, mips] = depth;
        let texture = |shrink, format| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(what),
                size: wgpu::Extent3d {
                    width: size[0] / shrink,
                    height: size[1] / shrink,
                    depth_or_array_layers: layers,
                },
                mip_level_count: mips,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_DST
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        Self {
            luma: texture(1, wgpu::TextureFormat::R8Unorm),
            chroma: texture(2, wgpu::TextureFormat::Rg8Unorm),
        }
    }

    /// Writes one plane of samples at luma position `at` of a layer; chroma as two planes at once.
    fn write(&self, gpu: &Gpu, place: SlotPlace, mip: u32, samples: [&Samples; 3]) {
        let [y, u, v] = samples;
        let at = place.at.map(|a| a >> mip);
        write(
            gpu,
            &self.luma,
            [at[0], at[1], place.layer, mip],
            y.size,
            &y.codes,
        );
        let pairs: Vec<u8> = u
            .codes
            .iter()
            .zip(&v.codes)
            .flat_map(|(&u, &v)| [u, v])
            .collect();
        let at = place.at.map(|a| (a / 2) >> mip);
        write(
            gpu,
            &self.chroma,
            [at[0], at[1], place.layer, mip],
            u.size,
            &pairs,
        );
    }

    /// Bytes of both textures, all mips and layers.
    fn bytes(&self) -> u64 {
        bytes(&self.luma) + bytes(&self.chroma)
    }

    /// Views of the luma and the chroma array, also where there is one layer.
    pub(crate) fn views(&self) -> [wgpu::TextureView; 2] {
        [&self.luma, &self.chroma].map(|texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..wgpu::TextureViewDescriptor::default()
            })
        })
    }
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, at: [u32; 4], size: [u32; 2], bytes: &[u8]) {
    let [x, y, z, mip_level] = at;
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
            bytes_per_row: Some(bytes.len() as u32 / size[1]),
            rows_per_image: None,
        },
        wgpu::Extent3d {
            width: size[0],
            height: size[1],
            depth_or_array_layers: 1,
        },
    );
}

fn bytes(texture: &wgpu::Texture) -> u64 {
    let texel = u64::from(texture.format().block_copy_size(None).unwrap_or(0));
    let texels: u64 = (0..texture.mip_level_count())
        .map(|mip| {
            let side = |s: u32| u64::from((s >> mip).max(1));
            side(texture.width()) * side(texture.height())
        })
        .sum();
    texels * texel * u64::from(texture.depth_or_array_layers())
}

/// Top left luma texel of a tile, and its layer.
#[derive(Clone, Copy, Debug)]
struct SlotPlace {
    at: [u32; 2],
    layer: u32,
}

/// The textures, without knowledge of what is in them.
pub(crate) struct Atlas {
    shape: SlotShape,
    most_layers: u32,
    layers: u32,
    pub(crate) tiles: Planes,
    pub(crate) base: Planes,
}

impl Atlas {
    /// An atlas of one layer that may grow to `most_layers`.
    pub(crate) fn new(gpu: &Gpu, grid: &TileGrid, most_layers: u32) -> Result<Self, RenderError> {
        let shape = SlotShape::new(grid);
        let limits = gpu.device.limits();
        let coarsest = grid.coarsest();
        let step = base_step(grid);
        let base = [0, 1].map(|k| grid.tiles(coarsest)[k] * step[k]);
        let check = |what, [w, h]: [u32; 2]| {
            let (side, most) = (w.max(h), limits.max_texture_dimension_2d);
            if side > most {
                return Err(RenderError::TooLarge { what, side, most });
            }
            Ok(())
        };
        check("the coarsest level", base)?;
        if coarsest > 0 {
            check("a tile", shape.slot)?;
        }
        let layer = if coarsest > 0 { shape.layer() } else { [2; 2] };
        let mips = if coarsest > 0 { shape.mips } else { 1 };
        Ok(Self {
            shape,
            most_layers: most_layers.clamp(1, limits.max_texture_array_layers.min(256)),
            layers: 1,
            tiles: Planes::new(gpu, "tile atlas", layer, [1, mips]),
            base: Planes::new(gpu, "coarsest level", base, [grid.faces(), 1]),
        })
    }

    /// Slots that exist now.
    pub(crate) fn slots(&self) -> u32 {
        self.layers * self.shape.slots()
    }

    /// Column, row and layer of a slot, each less than 256.
    pub(crate) fn place(&self, slot: u32) -> [u32; 3] {
        let rank = slot % self.shape.slots();
        let across = self.shape.across[0];
        [rank % across, rank / across, slot / self.shape.slots()]
    }

    /// Adds a layer, keeping what is there; false at the bound.
    pub(crate) fn grow(&mut self, gpu: &Gpu) -> bool {
        if self.layers == self.most_layers {
            return false;
        }
        let depth = [self.layers + 1, self.shape.mips];
        let larger = Planes::new(gpu, "tile atlas", self.shape.layer(), depth);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for (from, to) in [
            (&self.tiles.luma, &larger.luma),
            (&self.tiles.chroma, &larger.chroma),
        ] {
            for mip_level in 0..self.shape.mips {
                let mip = |texture| wgpu::TexelCopyTextureInfo {
                    texture,
                    mip_level,
                    origin: wgpu::Origin3d::ZERO,
                    aspect: wgpu::TextureAspect::All,
                };
                let size = wgpu::Extent3d {
                    width: from.width() >> mip_level,
                    height: from.height() >> mip_level,
                    depth_or_array_layers: self.layers,
                };
                encoder.copy_texture_to_texture(mip(from), mip(to), size);
            }
        }
        gpu.queue.submit([encoder.finish()]);
        self.tiles = larger;
        self.layers += 1;
        true
    }

    /// Writes a tile and its reductions into a slot; `planes` are Y, U, V as
    /// [`crate::reduce::pyramid`] gives them.
    pub(crate) fn write_slot(
        &self,
        gpu: &Gpu,
        slot: u32,
        octaves: u32,
        planes: &[Vec<Samples>; 3],
    ) {
        let [column, row, layer] = self.place(slot);
        let place = SlotPlace {
            at: [column * self.shape.slot[0], row * self.shape.slot[1]],
            layer,
        };
        let [y, u, v] = planes;
        for (step, ((y, u), v)) in (0..).zip(y.iter().zip(u).zip(v)) {
            self.tiles.write(gpu, place, step * octaves, [y, u, v]);
        }
    }

    /// Writes a tile of the coarsest level.
    pub(crate) fn write_base(&self, gpu: &Gpu, grid: &TileGrid, tile: Tile, planes: [&Samples; 3]) {
        let step = base_step(grid);
        let place = SlotPlace {
            at: [u32::from(tile.x) * step[0], u32::from(tile.y) * step[1]],
            layer: u32::from(tile.face),
        };
        self.base.write(gpu, place, 0, planes);
    }

    /// Bytes of all textures.
    pub(crate) fn bytes(&self) -> u64 {
        self.tiles.bytes() + self.base.bytes()
    }
}

/// Pixels from one tile of the coarsest level to the next in the base texture: even, for chroma.
fn base_step(grid: &TileGrid) -> [u32; 2] {
    let first = grid.tile_at(grid.coarsest(), 0);
    grid.tile_size(first).map(|s| s.next_multiple_of(2))
}
