//! Where on the GPU do the texels of pages lie?
//!
//! In one texture array whose layers are cut into slots of one page each. It grows by layers.

use crate::gpu::device::Gpu;
use crate::gpu::textures::{texture_array, write_texels};
use crate::pages::table::PageSlot;
use foveal_core::content::images::picture::TexturePicture;
use foveal_core::content::images::shape::{SLOT_BYTES, SLOT_SIDE};

/// Light is linear once it is read.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Slots along a side of a layer: few where little memory may be taken, so that little lies idle.
const ACROSS: [u32; 3] = [2, 4, 7];

/// A texture array of slots.
pub(crate) struct PageAtlas {
    texture: wgpu::Texture,
    across: u32,
    layers: u32,
    most_layers: u32,
    free: Vec<PageSlot>,
}

impl PageAtlas {
    /// No slot yet, for up to about `most_bytes`.
    pub(crate) fn new(gpu: &Gpu, most_bytes: u64) -> Self {
        let most_layers = gpu.device.limits().max_texture_array_layers.min(256);
        let holds = |across: &u32| layer_bytes(*across) * u64::from(most_layers) >= most_bytes;
        Self {
            texture: texture(gpu, 1, 1),
            across: ACROSS.into_iter().find(holds).unwrap_or(ACROSS[2]),
            layers: 0,
            most_layers,
            free: Vec::new(),
        }
    }

    /// Bytes of all slots, in use or not.
    pub(crate) fn bytes(&self) -> u64 {
        u64::from(self.layers) * layer_bytes(self.across)
    }

    /// A view of all layers.
    pub(crate) fn view(&self) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..wgpu::TextureViewDescriptor::default()
        })
    }

    /// A free slot; grows to at most `most_bytes` where there is none. `None` where that is not
    /// enough.
    pub(crate) fn take(&mut self, gpu: &Gpu, most_bytes: u64) -> Option<PageSlot> {
        if self.free.is_empty() {
            let most = (most_bytes / layer_bytes(self.across)) as u32;
            let most = most.min(self.most_layers);
            // In larger steps the larger it is: what is there is copied.
            let layers = (self.layers + 1 + self.layers / 4).min(most);
            if layers <= self.layers {
                return None;
            }
            self.grow(gpu, layers);
        }
        self.free.pop()
    }

    /// Gives back what [`Self::take`] gave.
    pub(crate) fn give_back(&mut self, slots: impl IntoIterator<Item = PageSlot>) {
        self.free.extend(slots);
    }

    fn grow(&mut self, gpu: &Gpu, layers: u32) {
        let side = self.across * SLOT_SIDE;
        let larger = texture(gpu, side, layers);
        if self.layers > 0 {
            let mut encoder = gpu.encoder("growth of the pages");
            let [from, to] = [&self.texture, &larger].map(wgpu::Texture::as_image_copy);
            let size = wgpu::Extent3d {
                width: side,
                height: side,
                depth_or_array_layers: self.layers,
            };
            encoder.copy_texture_to_texture(from, to, size);
            gpu.submit(encoder);
        }
        self.texture = larger;
        let across = self.across;
        let new = (self.layers..layers).rev().flat_map(|layer| {
            let slots = (0..across * across).rev();
            slots.map(move |slot| PageSlot {
                at: [slot % across, slot / across].map(|it| (it * SLOT_SIDE) as u16),
                layer: layer as u16,
            })
        });
        self.free.extend(new);
        self.layers = layers;
    }

    /// Whether less than half of the slots are in use.
    pub(crate) fn is_mostly_free(&self) -> bool {
        2 * self.free.len() > (self.layers * self.across * self.across) as usize
    }

    /// Keeps these slots alone, in as few layers as hold them, and returns where they lie now.
    pub(crate) fn pack(&mut self, gpu: &Gpu, used: &[PageSlot]) -> Vec<PageSlot> {
        let mut packed = Self {
            texture: texture(gpu, 1, 1),
            layers: 0,
            free: Vec::new(),
            ..*self
        };
        let layers = (used.len() as u32).div_ceil(self.across * self.across);
        if layers > 0 {
            packed.grow(gpu, layers);
        }
        let places: Vec<PageSlot> = used.iter().filter_map(|_| packed.free.pop()).collect();
        let mut encoder = gpu.encoder("pages in fewer layers");
        for (from, to) in used.iter().zip(&places) {
            let [from, to] =
                [(&self.texture, from), (&packed.texture, to)].map(|(texture, slot)| {
                    wgpu::TexelCopyTextureInfo {
                        origin: origin_of(*slot),
                        ..texture.as_image_copy()
                    }
                });
            let size = wgpu::Extent3d {
                width: SLOT_SIDE,
                height: SLOT_SIDE,
                depth_or_array_layers: 1,
            };
            encoder.copy_texture_to_texture(from, to, size);
        }
        gpu.submit(encoder);
        *self = packed;
        places
    }

    /// Writes a page with its border into a slot.
    pub(crate) fn write(&self, gpu: &Gpu, slot: PageSlot, picture: &TexturePicture) {
        let wgpu::Origin3d { x, y, z } = origin_of(slot);
        write_texels(
            gpu,
            &self.texture,
            [x, y, z, 0],
            picture.size,
            picture.bytes(),
        );
    }
}

fn origin_of(slot: PageSlot) -> wgpu::Origin3d {
    let [x, y] = slot.at.map(u32::from);
    let z = u32::from(slot.layer);
    wgpu::Origin3d { x, y, z }
}

fn layer_bytes(across: u32) -> u64 {
    u64::from(across * across) * SLOT_BYTES
}

fn texture(gpu: &Gpu, side: u32, layers: u32) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_DST
        | wgpu::TextureUsages::COPY_SRC;
    let size = [side, side, layers, 1];
    texture_array(&gpu.device, "pages of textures", size, FORMAT, usage)
}
