//! How is a pass recorded that draws the resident tiles?

use crate::gpu::buffers::written;
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::Area;
use crate::gpu::screen_pass::{Reads, ScreenPass};
use crate::params::{Overlay, ViewParams};
use crate::shaders::Shader;
use crate::tiles::store::TileStore;

/// The bindings of `shaders/shared/tiles.wgsl`, then the view.
const READS: [(u32, Reads); 5] = [
    (0, Reads::Uniform),
    (1, Reads::Storage),
    (2, Reads::Layers),
    (3, Reads::Layers),
    (4, Reads::Uniform),
];
const MARKS: (u32, Reads) = (5, Reads::Uniform);

/// A pass over the resident tiles, with its own parameters: recorded once a frame.
pub(crate) struct TilePass {
    pass: ScreenPass,
    view: wgpu::Buffer,
    marks: Option<wgpu::Buffer>,
    bound: Option<(u64, wgpu::BindGroup)>,
}

impl TilePass {
    /// A pass that replaces the picture.
    pub(crate) fn new(gpu: &Gpu, shader: &Shader) -> Self {
        Self::with(gpu, ScreenPass::new(gpu, shader, &READS), None)
    }

    /// A pass that blends over the picture and takes [`Overlay`] parameters.
    pub(crate) fn over(gpu: &Gpu, shader: &Shader) -> Self {
        let reads = [READS.as_slice(), &[MARKS]].concat();
        let marks = uniform(gpu, size_of::<Overlay>());
        Self::with(gpu, ScreenPass::over(gpu, shader, &reads), Some(marks))
    }

    /// The same pass with parameters of its own, for a frame that has it twice.
    pub(crate) fn again(&self, gpu: &Gpu) -> Self {
        let marks = self.marks.as_ref();
        let marks = marks.map(|_| uniform(gpu, size_of::<Overlay>()));
        Self::with(gpu, self.pass.clone(), marks)
    }

    fn with(gpu: &Gpu, pass: ScreenPass, marks: Option<wgpu::Buffer>) -> Self {
        Self {
            pass,
            view: uniform(gpu, size_of::<ViewParams>()),
            marks,
            bound: None,
        }
    }

    /// Records the pass over an area.
    pub(crate) fn record(
        &mut self,
        (gpu, encoder): (&Gpu, &mut wgpu::CommandEncoder),
        tiles: &TileStore,
        area: Area<'_>,
        view: &ViewParams,
        marks: Option<&Overlay>,
    ) {
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(view));
        if let (Some(buffer), Some(marks)) = (&self.marks, marks) {
            gpu.queue.write_buffer(buffer, 0, bytemuck::bytes_of(marks));
        }
        let bound = match self.bound.take() {
            Some((generation, bound)) if generation == tiles.generation() => bound,
            _ => self.bind(gpu, tiles),
        };
        self.pass.record(encoder, &bound, area);
        self.bound = Some((tiles.generation(), bound));
    }

    fn bind(&self, gpu: &Gpu, tiles: &TileStore) -> wgpu::BindGroup {
        let ([params, cells], [luma, chroma]) = tiles.bindings();
        let mut resources = vec![
            (0, params.as_entire_binding()),
            (1, cells.as_entire_binding()),
            (2, wgpu::BindingResource::TextureView(&luma)),
            (3, wgpu::BindingResource::TextureView(&chroma)),
            (4, self.view.as_entire_binding()),
        ];
        let marks = self.marks.as_ref();
        resources.extend(marks.map(|marks| (MARKS.0, marks.as_entire_binding())));
        self.pass.bind(gpu, &resources)
    }
}

fn uniform(gpu: &Gpu, bytes: usize) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM;
    written(gpu, "parameters of a pass", bytes as u64, usage)
}
