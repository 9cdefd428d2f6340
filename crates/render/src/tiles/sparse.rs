//! How does the GPU hold samples round the gaze, and how are they drawn?

use crate::error::RenderError;
use crate::gpu::buffers::written;
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::PictureTarget;
use crate::gpu::screen_pass::{Reads, ScreenPass};
use crate::params::{SparseParams, ViewParams};
use crate::shaders;
use crate::tiles::store::TileStore;
use foveal_core::perception::samples::sample_mask::SampleMask;
use foveal_core::view::surface::Projection;

/// How the pixels between samples are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// From the nearest sample (Kastner 2016).
    Nearest,
    /// From the nearest sample and those that touch it, by distance.
    #[default]
    Blended,
}

/// A mask on the GPU and the colours of its samples.
pub(crate) struct SparseStore {
    pass: ScreenPass,
    params: SparseParams,
    view: wgpu::Buffer,
    uniform: wgpu::Buffer,
    /// Nearest sample of every pixel, colours, places, neighbours; the last two only to blend.
    tables: [wgpu::Buffer; 4],
    samples: usize,
    bound: Option<(u64, wgpu::BindGroup)>,
}

impl SparseStore {
    /// Uploads a mask, once; refuses one that is larger than the device binds.
    pub(crate) fn new(
        gpu: &Gpu,
        projection: Projection,
        mask: &SampleMask,
        interpolation: Interpolation,
    ) -> Result<Self, RenderError> {
        let blends = interpolation == Interpolation::Blended;
        let places = mask
            .places
            .iter()
            .map(|[x, y]| u32::from(*x) | u32::from(*y) << 16);
        let places: Vec<u32> = places.take(if blends { usize::MAX } else { 1 }).collect();
        let neighbours = mask.neighbours.as_flattened();
        let neighbours = if blends { neighbours } else { &neighbours[..1] };
        let colours = vec![0; mask.places.len()];
        let table = |words: &[u32]| {
            let (bytes, most) = (
                size_of_val(words) as u64,
                gpu.device.limits().max_storage_buffer_binding_size,
            );
            let what = "a table of the sample mask";
            if bytes > most {
                return Err(RenderError::TooMuch { what, bytes, most });
            }
            let made = written(gpu, "samples", bytes, wgpu::BufferUsages::STORAGE);
            gpu.queue
                .write_buffer(&made, 0, bytemuck::cast_slice(words));
            Ok(made)
        };
        let reads = [
            (0, Reads::Uniform),
            (1, Reads::Storage),
            (2, Reads::Layers),
            (3, Reads::Layers),
            (4, Reads::Uniform),
            (5, Reads::Uniform),
            (6, Reads::Storage),
            (7, Reads::Storage),
            (8, Reads::Storage),
            (9, Reads::Storage),
        ];
        let uniform = |bytes: usize| {
            let usage = wgpu::BufferUsages::UNIFORM;
            written(gpu, "sparse", bytes as u64, usage)
        };
        Ok(Self {
            pass: ScreenPass::new(gpu, &shaders::interpolate_sparse(projection), &reads),
            params: SparseParams::new(mask, blends),
            view: uniform(size_of::<ViewParams>()),
            uniform: uniform(size_of::<SparseParams>()),
            tables: [
                table(&mask.nearest)?,
                table(&colours)?,
                table(&places)?,
                table(neighbours)?,
            ],
            samples: mask.places.len(),
            bound: None,
        })
    }

    /// Shows these colours, one a sample, with the mask's top left pixel at `corner` of the view.
    pub(crate) fn show(
        &mut self,
        gpu: &Gpu,
        corner: [i32; 2],
        codes: &[u32],
    ) -> Result<(), RenderError> {
        if codes.len() != self.samples {
            return Err(RenderError::Misfit {
                what: "the list of samples".to_owned(),
                expected: format!("as long as the mask has samples, {}", self.samples),
                found: format!("{} long", codes.len()),
            });
        }
        self.params.corner = corner;
        gpu.queue
            .write_buffer(&self.tables[1], 0, bytemuck::cast_slice(codes));
        Ok(())
    }

    /// Records the pass over the whole of `target`.
    pub(crate) fn record(
        &mut self,
        (gpu, encoder): (&Gpu, &mut wgpu::CommandEncoder),
        tiles: &TileStore,
        target: &PictureTarget,
        view: &ViewParams,
    ) {
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(view));
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.params));
        let bound = match self.bound.take() {
            Some((generation, bound)) if generation == tiles.generation() => bound,
            _ => self.bind(gpu, tiles),
        };
        self.pass.record(encoder, &bound, target.whole());
        self.bound = Some((tiles.generation(), bound));
    }

    /// Bytes of GPU memory of the samples and their tables.
    pub(crate) fn bytes(&self) -> u64 {
        let tables = self.tables.iter().map(wgpu::Buffer::size).sum::<u64>();
        tables + self.uniform.size()
    }

    fn bind(&self, gpu: &Gpu, tiles: &TileStore) -> wgpu::BindGroup {
        let ([params, cells], [luma, chroma]) = tiles.bindings();
        let [nearest, codes, places, neighbours] = &self.tables;
        let resources = [
            (0, params.as_entire_binding()),
            (1, cells.as_entire_binding()),
            (2, wgpu::BindingResource::TextureView(&luma)),
            (3, wgpu::BindingResource::TextureView(&chroma)),
            (4, self.view.as_entire_binding()),
            (5, self.uniform.as_entire_binding()),
            (6, nearest.as_entire_binding()),
            (7, codes.as_entire_binding()),
            (8, places.as_entire_binding()),
            (9, neighbours.as_entire_binding()),
        ];
        self.pass.bind(gpu, &resources)
    }
}
