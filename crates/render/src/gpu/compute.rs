//! How is a compute pass built, and how are several recorded?

use crate::gpu::bindings::bind;
use crate::gpu::device::Gpu;
use crate::gpu::pipeline::module;
use crate::gpu::timer::Timer;
use crate::shaders::ComputeShader;

/// A compute pass, ready to be given what it reads and writes.
///
/// ```
/// # #[cfg(not(target_arch = "wasm32"))] {
/// use foveal_render::gpu::buffers::storage;
/// use foveal_render::gpu::compute::{Compute, record};
/// use foveal_render::gpu::readback::BytesBack;
/// use foveal_render::{Gpu, shaders::ComputeShader};
///
/// let gpu = Gpu::open_blocking()?;
/// let text = "@group(0) @binding(0) var<storage, read_write> numbers: array<u32>;
///     @compute @workgroup_size(4) fn count(@builtin(global_invocation_id) at: vec3u) {
///         numbers[at.x] = at.x + 7u;
///     }";
/// let count = Compute::new(&gpu, &ComputeShader { name: "count", text: text.to_owned() });
/// let numbers = storage(&gpu, "numbers", 16)?;
/// let four = count.over(&gpu, [4, 1], [4, 1], &[(0, numbers.as_entire_binding())]);
///
/// let mut encoder = gpu.encoder("example");
/// record(&mut encoder, "count", None, [&four]);
/// let back = BytesBack::buffer(&gpu, 16);
/// encoder.copy_buffer_to_buffer(&numbers, 0, &back, 0, 16);
/// gpu.submit(encoder);
/// let bytes = BytesBack::map(back).wait(&gpu)?;
/// assert_eq!(bytes[4..8], 8_u32.to_le_bytes());
/// # }
/// # Ok::<(), foveal_render::RenderError>(())
/// ```
pub struct Compute {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// A pass over certain buffers and textures.
pub struct Dispatch {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    workgroups: [u32; 2],
}

impl Compute {
    /// The pass of a shader, whose text says what is bound in group 0.
    #[must_use]
    pub fn new(gpu: &Gpu, shader: &ComputeShader) -> Self {
        let module = module(gpu, shader.name, &shader.text);
        let pipeline = gpu
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(shader.name),
                layout: None,
                module: &module,
                entry_point: Some(shader.name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
        Self {
            name: shader.name,
            layout: pipeline.get_bind_group_layout(0),
            pipeline,
        }
    }

    /// The pass over `bindings`, each with its number, for `size` texels of which a workgroup does
    /// `tile`; both are columns and rows.
    #[must_use]
    pub fn over(
        &self,
        gpu: &Gpu,
        size: [u32; 2],
        tile: [u32; 2],
        bindings: &[(u32, wgpu::BindingResource<'_>)],
    ) -> Dispatch {
        Dispatch {
            pipeline: self.pipeline.clone(),
            group: bind(gpu, self.name, &self.layout, bindings),
            workgroups: [0, 1].map(|k| size[k].div_ceil(tile[k])),
        }
    }
}

/// Records `dispatches` one after the other; each sees what those before it wrote. `timer`, where
/// there is one, is stamped before the first and after the last.
pub fn record<'a>(
    encoder: &mut wgpu::CommandEncoder,
    name: &'static str,
    timer: Option<&Timer>,
    dispatches: impl IntoIterator<Item = &'a Dispatch>,
) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
        label: Some(name),
        timestamp_writes: timer.map(Timer::around),
    });
    for dispatch in dispatches {
        pass.set_pipeline(&dispatch.pipeline);
        pass.set_bind_group(0, &dispatch.group, &[]);
        let [x, y] = dispatch.workgroups;
        pass.dispatch_workgroups(x, y, 1);
    }
}
