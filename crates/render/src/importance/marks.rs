//! How is what units are worth painted over a picture of them?

use crate::error::RenderError;
use crate::gpu::buffers::storage;
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::Area;
use crate::gpu::screen_pass::{Reads, ScreenPass};
use crate::shaders;

/// What units are worth, and the pass that paints it.
pub(crate) struct UnitMarks {
    pass: ScreenPass,
    worths: wgpu::Buffer,
}

impl UnitMarks {
    /// Paints these worths, of units by their numbers.
    ///
    /// # Errors
    /// The device binds no buffer for as many units.
    pub(crate) fn new(gpu: &Gpu, worths: &[f32]) -> Result<Self, RenderError> {
        let reads = [(0, Reads::Units), (1, Reads::Storage)];
        let mut marks = Self {
            pass: ScreenPass::over(gpu, &shaders::mark_units(), &reads),
            worths: storage(gpu, "worth of units", 0)?,
        };
        marks.fill(gpu, worths)?;
        Ok(marks)
    }

    /// From now on paints these.
    ///
    /// # Errors
    /// The device binds no buffer for as many units.
    pub(crate) fn fill(&mut self, gpu: &Gpu, worths: &[f32]) -> Result<(), RenderError> {
        let bytes = size_of_val(worths) as u64;
        if self.worths.size() != bytes {
            self.worths = storage(gpu, "worth of units", bytes)?;
        }
        let worths = bytemuck::cast_slice(worths);
        gpu.queue.write_buffer(&self.worths, 0, worths);
        Ok(())
    }

    /// Paints over a picture, of which `units` names those that would refine it, pixel by pixel.
    pub(crate) fn paint(&self, gpu: &Gpu, units: &wgpu::Texture, picture: &wgpu::TextureView) {
        let units = units.create_view(&wgpu::TextureViewDescriptor::default());
        let resources = [
            (0, wgpu::BindingResource::TextureView(&units)),
            (1, self.worths.as_entire_binding()),
        ];
        let bound = self.pass.bind(gpu, &resources);
        let mut encoder = gpu.encoder("worth of units");
        self.pass
            .record(&mut encoder, &bound, Area::of_view(picture));
        gpu.submit(encoder);
    }
}
