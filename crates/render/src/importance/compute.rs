//! How is a compute pass ordered?

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::shaders::ComputeShader;

/// A compute pass, ready to be given what it reads and writes.
pub(super) struct Compute {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// A pass over certain buffers and textures.
pub(super) struct Dispatch {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    workgroups: [u32; 2],
}

impl Compute {
    pub(super) fn new(gpu: &Gpu, shader: &ComputeShader) -> Self {
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
            });
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

    /// The pass over `bindings`, for `size` texels of which a workgroup does `tile`.
    pub(super) fn over(
        &self,
        gpu: &Gpu,
        size: [u32; 2],
        tile: [u32; 2],
        bindings: &[(u32, wgpu::BindingResource<'_>)],
    ) -> Dispatch {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = bindings
            .iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: resource.clone(),
            })
            .collect();
        Dispatch {
            pipeline: self.pipeline.clone(),
            group: gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(self.name),
                layout: &self.layout,
                entries: &entries,
            }),
            workgroups: [0, 1].map(|k| size[k].div_ceil(tile[k])),
        }
    }
}

impl Dispatch {
    pub(super) fn order(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        let [x, y] = self.workgroups;
        pass.dispatch_workgroups(x, y, 1);
    }
}

/// A storage buffer of `bytes`, filled with zeros.
pub(super) fn storage(
    gpu: &Gpu,
    what: &'static str,
    bytes: u64,
) -> Result<wgpu::Buffer, RenderError> {
    let limits = gpu.device.limits();
    let most = limits
        .max_storage_buffer_binding_size
        .min(limits.max_buffer_size);
    if bytes > most {
        return Err(RenderError::TooMuch { what, bytes, most });
    }
    Ok(gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: bytes.max(8),
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    }))
}

/// A storage or uniform buffer that holds `values`.
pub(super) fn filled<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    what: &'static str,
    usage: wgpu::BufferUsages,
    values: &[T],
) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: bytes.len() as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}
