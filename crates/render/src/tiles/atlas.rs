//! Where on the GPU do the samples of tiles lie?
//!
//! In one texture array of luma and one of chroma, both divided as [`AtlasShape`] says, which grow
//! by layers. Chroma has two channels and half the size: U and V are always read together.

use crate::gpu::textures::{layers_of, paired, texture_array, write_texels};
use crate::tiles::atlas_shape::AtlasShape;
use crate::{error::RenderError, gpu::device::Gpu};
use foveal_core::content::video::grid::tile_grid::Tile;

/// A luma texture array and a chroma texture array of half its size.
pub(crate) struct Planes {
    pub(crate) luma: wgpu::Texture,
    pub(crate) chroma: wgpu::Texture,
}

/// Columns and rows of a plane of a tile, and its codes row by row.
pub(crate) type PlaneCodes<'a> = ([u32; 2], &'a [u8]);

impl Planes {
    /// Formats of luma and of chroma.
    pub(crate) const FORMATS: [wgpu::TextureFormat; 2] =
        [wgpu::TextureFormat::R8Unorm, wgpu::TextureFormat::Rg8Unorm];

    fn new(gpu: &Gpu, shape: &AtlasShape, layers: u32) -> Self {
        let texture = |shrink, format| {
            let [width, height] = shape.layer.map(|side| side / shrink);
            let size = [width, height, layers, shape.mips];
            let usage = wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC;
            texture_array(&gpu.device, "atlas", size, format, usage)
        };
        let [luma, chroma] = Self::FORMATS;
        Self {
            luma: texture(1, luma),
            chroma: texture(2, chroma),
        }
    }

    /// Writes Y, U and V at a place, given by column and row of the luma texel in mip 0 and layer.
    pub(crate) fn write(&self, gpu: &Gpu, place: [u32; 3], mip: u32, planes: [PlaneCodes<'_>; 3]) {
        let [y, u, v] = planes;
        let [left, top, layer] = place;
        let at = [left >> mip, top >> mip, layer, mip];
        write_texels(gpu, &self.luma, at, y.0, y.1);
        let at = [(left / 2) >> mip, (top / 2) >> mip, layer, mip];
        write_texels(gpu, &self.chroma, at, u.0, &paired(u.1, v.1));
    }

    /// Bytes of both textures, all mips and layers.
    pub(crate) fn bytes(&self) -> u64 {
        bytes(&self.luma) + bytes(&self.chroma)
    }

    /// Views of the luma and the chroma array.
    pub(crate) fn views(&self) -> [wgpu::TextureView; 2] {
        [&self.luma, &self.chroma].map(|it| layers_of(it, 0..it.mip_level_count()))
    }
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

/// Column, row and layer of a slot, each less than 256.
pub(crate) type SlotPlace = [u32; 3];

/// Most layers: a slot's layer is 8 bits.
const MOST_LAYERS: u32 = 256;

/// The textures, without knowledge of what is in them.
pub(crate) struct Atlas {
    shape: AtlasShape,
    most_layers: u32,
    layers: u32,
    pub(crate) planes: Planes,
}

impl Atlas {
    /// An atlas of the layers that the coarsest level needs, which may grow to `most_layers`, or to
    /// one more than those if that is more.
    pub(crate) fn new(gpu: &Gpu, shape: AtlasShape, most_layers: u32) -> Result<Self, RenderError> {
        let limits = gpu.device.limits();
        let (side, most) = (
            shape.layer[0].max(shape.layer[1]),
            limits.max_texture_dimension_2d,
        );
        if side > most {
            let what = "a tile, or the coarsest level of a face,";
            return Err(RenderError::TooLarge { what, side, most });
        }
        let layers = shape.base_layers();
        let most = limits.max_texture_array_layers.min(MOST_LAYERS);
        Ok(Self {
            shape,
            most_layers: most_layers.max(layers + 1).min(most),
            layers,
            planes: Planes::new(gpu, &shape, layers),
        })
    }

    /// Column, row and layer of every slot that exists now, each less than 256.
    pub(crate) fn slots(&self) -> impl Iterator<Item = SlotPlace> + '_ {
        (0..self.layers).flat_map(|layer| self.shape.slots_in(layer))
    }

    /// Adds a layer, keeping what is there; returns its slots, none at the bound.
    pub(crate) fn grow(&mut self, gpu: &Gpu) -> Vec<SlotPlace> {
        if self.layers == self.most_layers {
            return Vec::new();
        }
        let larger = Planes::new(gpu, &self.shape, self.layers + 1);
        let mut encoder = gpu.encoder("growth of the atlas");
        for (from, to) in [
            (&self.planes.luma, &larger.luma),
            (&self.planes.chroma, &larger.chroma),
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
        gpu.submit(encoder);
        self.planes = larger;
        self.layers += 1;
        self.shape.slots_in(self.layers - 1)
    }

    /// Column and row of the first luma texel in a slot, and its layer.
    pub(crate) fn texel_of_slot(&self, [column, row, layer]: SlotPlace) -> [u32; 3] {
        [column * self.shape.slot[0], row * self.shape.slot[1], layer]
    }

    /// Column and row of the first luma texel of a tile of the coarsest level, and its layer.
    pub(crate) fn texel_of_base(&self, tile: Tile) -> [u32; 3] {
        let [left, top, layer] = self.shape.base_place(u32::from(tile.face));
        let [step_x, step_y] = self.shape.base_step;
        [
            left + u32::from(tile.x) * step_x,
            top + u32::from(tile.y) * step_y,
            layer,
        ]
    }
}
