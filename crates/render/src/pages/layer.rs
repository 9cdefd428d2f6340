//! Which pages of textures are on the GPU?

use crate::error::RenderError;
use crate::gpu::buffers::storage;
use crate::gpu::device::Gpu;
use crate::pages::atlas::PageAtlas;
use crate::pages::table::PageTable;
use foveal_core::content::images::payload::ImagePage;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use std::collections::HashSet;

/// A page of a texture on its way to where it is drawn from.
#[derive(Clone, Copy, Debug)]
pub struct ComingPage<'a> {
    /// Its unit.
    pub unit: UnitId,
    /// Its prerequisites: the page that it lies in, which is there; of a root none.
    pub needs: &'a [UnitId],
    /// What it shows.
    pub says: &'a ImagePage,
}

/// Pages on the GPU, and the table by which shaders find them.
pub(crate) struct PageLayer {
    gpu: Gpu,
    table: PageTable,
    atlas: PageAtlas,
    words: wgpu::Buffer,
    sampler: wgpu::Sampler,
}

impl PageLayer {
    /// No page of these textures, for up to about `most_bytes`.
    ///
    /// # Errors
    /// The textures have more pages than the device binds a table of.
    pub(crate) fn new(
        gpu: &Gpu,
        textures: &[SceneTexture],
        objects: &[SceneObject],
        most_bytes: u64,
    ) -> Result<Self, RenderError> {
        let table = PageTable::new(textures, objects);
        let bytes = size_of_val(table.words()) as u64;
        Ok(Self {
            words: storage(gpu, "table of pages", bytes)?,
            atlas: PageAtlas::new(gpu, most_bytes),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("pages of textures"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..wgpu::SamplerDescriptor::default()
            }),
            gpu: gpu.clone(),
            table,
        })
    }

    /// Which pages are there.
    pub(crate) fn table(&self) -> &PageTable {
        &self.table
    }

    /// Bytes of pages, in use or not, and of their table.
    pub(crate) fn bytes(&self) -> u64 {
        self.atlas.bytes() + self.words.size()
    }

    /// What shaders read: the table, the pages, and how they are read.
    pub(crate) fn bindings(&self) -> (&wgpu::Buffer, wgpu::TextureView, &wgpu::Sampler) {
        (&self.words, self.atlas.view(), &self.sampler)
    }

    /// Adds a page, where all pages may take `most_bytes`; `false` where there is no room for it.
    /// One that is there stays as it is.
    ///
    /// # Errors
    /// It does not fit to what is there.
    pub(crate) fn upload(
        &mut self,
        coming: &ComingPage<'_>,
        most_bytes: u64,
    ) -> Result<bool, RenderError> {
        let ComingPage { unit, needs, says } = *coming;
        if self.table.is_there(unit) {
            return Ok(true);
        }
        let pictures = self.table.pictures_of(unit, needs, says)?;
        let mut slots = Vec::new();
        for picture in &pictures {
            let Some(slot) = self.atlas.take(&self.gpu, most_bytes) else {
                self.atlas.give_back(slots);
                return Ok(false);
            };
            self.atlas.write(&self.gpu, slot, picture);
            slots.push(slot);
        }
        self.table
            .insert(unit, needs, (says.texture, says.page), slots);
        Ok(true)
    }

    /// Takes away all pages but those that are wanted, what these need, and roots.
    pub(crate) fn retain(&mut self, wanted: &HashSet<UnitId>) {
        let free = self.table.retain(wanted);
        self.atlas.give_back(free);
    }

    /// Writes to the GPU what changed of the table.
    pub(crate) fn settle(&mut self) {
        let changed = self.table.take_changed();
        if !changed.is_empty() {
            let bytes = bytemuck::cast_slice(&self.table.words()[changed.clone()]);
            let at = (changed.start * size_of::<u32>()) as u64;
            self.gpu.queue.write_buffer(&self.words, at, bytes);
        }
    }
}
