//! Which pages of textures are on the GPU?

use crate::error::RenderError;
use crate::gpu::buffers::storage;
use crate::gpu::device::Gpu;
use crate::gpu::room::TakenBytes;
use crate::idle::IdleUnits;
use crate::pages::atlas::PageAtlas;
use crate::pages::table::{PageSlot, PageTable};
use crate::scene::coming::Coming;
use crate::scene::kind::{Frame, KindLayer, Textures};
use crate::scene::phase::{Go, Phase};
use foveal_core::content::payload::PayloadView;
use foveal_core::content::scene::description::{SceneObject, SceneTexture};
use foveal_core::pack::unit::UnitId;
use std::collections::HashSet;

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

    /// A free slot: what is not shown gives way before the atlas grows.
    fn take_slot(&mut self, most_bytes: u64) -> Option<PageSlot> {
        loop {
            if let Some(slot) = self.atlas.take(&self.gpu, 0) {
                return Some(slot);
            }
            match self.table.give_way() {
                Some(slots) => self.atlas.give_back(slots),
                None => return self.atlas.take(&self.gpu, most_bytes),
            }
        }
    }

    /// Gives back layers where most of them is free.
    fn pack(&mut self) {
        if self.atlas.is_mostly_free() {
            let used: Vec<PageSlot> = self.table.slots().collect();
            let places = self.atlas.pack(&self.gpu, &used);
            self.table.move_to(places.into_iter());
        }
    }

    /// Writes to the GPU what changed of the table.
    fn settle(&mut self) {
        let changed = self.table.take_changed();
        if !changed.is_empty() {
            let bytes = bytemuck::cast_slice(&self.table.words()[changed.clone()]);
            let at = (changed.start * size_of::<u32>()) as u64;
            self.gpu.queue.write_buffer(&self.words, at, bytes);
        }
    }
}

impl KindLayer for PageLayer {
    fn takes(&self, coming: &Coming<'_>) -> bool {
        matches!(coming.payload, PayloadView::Image(_))
    }

    fn upload(&mut self, coming: &Coming<'_>, allowed: TakenBytes) -> Result<bool, RenderError> {
        let PayloadView::Image(payload) = coming.payload else {
            return Err(RenderError::OtherKind);
        };
        let Coming { unit, needs, .. } = *coming;
        if self.table.show_again(unit) || self.table.is_there(unit) {
            return Ok(true);
        }
        let pictures = self.table.pictures_of(unit, needs, payload)?;
        let mut slots = Vec::new();
        for picture in &pictures {
            let Some(slot) = self.take_slot(allowed.held) else {
                self.atlas.give_back(slots);
                return Ok(false);
            };
            self.atlas.write(&self.gpu, slot, picture);
            slots.push(slot);
        }
        self.table
            .insert(unit, needs, (payload.texture, payload.page), slots);
        Ok(true)
    }

    fn remove(&mut self, _unit: UnitId) -> bool {
        false
    }

    fn keep(&mut self, wanted: &HashSet<UnitId>, staying: &[UnitId]) {
        let free = self.table.keep(wanted, staying);
        self.atlas.give_back(free);
        self.pack();
    }

    fn show(&mut self, unit: UnitId) -> bool {
        self.table.show_again(unit)
    }

    fn idle(&mut self) -> Option<&mut IdleUnits<UnitId>> {
        Some(&mut self.table.idle)
    }

    /// Pages give way to all other units: no room was promised to them.
    fn taken(&self) -> TakenBytes {
        TakenBytes {
            used: 0,
            held: self.atlas.bytes() + self.words.size(),
        }
    }

    fn give_back(&mut self, _must: bool) -> Result<(), RenderError> {
        while let Some(slots) = self.table.give_way() {
            self.atlas.give_back(slots);
        }
        self.pack();
        Ok(())
    }

    fn textures(&self) -> Option<Textures> {
        Some(Textures {
            table: self.words.clone(),
            pages: self.atlas.view(),
            sampler: self.sampler.clone(),
        })
    }

    fn prepare(
        &mut self,
        _encoder: &mut wgpu::CommandEncoder,
        _frame: &Frame<'_>,
    ) -> Result<(), RenderError> {
        self.settle();
        Ok(())
    }

    fn draw(&self, _pass: &mut wgpu::RenderPass<'_>, _phase: Phase, _go: Go) {}
}
