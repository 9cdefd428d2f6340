//! How is a pass drawn that reads whatever it is given?

use crate::gpu::device::Gpu;
use crate::shaders::Shader;
use crate::tiles::passes::FORMAT;

/// A full-screen pass that replaces the picture, with bindings of its own.
pub(crate) struct ScreenPass {
    name: &'static str,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

/// What a binding reads.
#[derive(Clone, Copy)]
pub(crate) enum Reads {
    Uniform,
    Storage,
    /// Texels one by one.
    Layers,
    /// Texels one by one, or between them with a [`Reads::Sampler`].
    Picture,
    Sampler,
}

impl Reads {
    fn binding(self) -> wgpu::BindingType {
        let buffer = |ty| wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = |filterable, view_dimension| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        match self {
            Self::Uniform => buffer(wgpu::BufferBindingType::Uniform),
            Self::Storage => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
            Self::Layers => texture(false, wgpu::TextureViewDimension::D2Array),
            Self::Picture => texture(true, wgpu::TextureViewDimension::D2),
            Self::Sampler => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        }
    }
}

impl ScreenPass {
    /// The pass of a shader of one step, with what it reads at each binding.
    pub(crate) fn new(gpu: &Gpu, shader: &Shader, reads: &[(u32, Reads)]) -> Self {
        let entry = |(binding, reads): &(u32, Reads)| wgpu::BindGroupLayoutEntry {
            binding: *binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: reads.binding(),
            count: None,
        };
        let entries: Vec<wgpu::BindGroupLayoutEntry> = reads.iter().map(entry).collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(shader.name),
                entries: &entries,
            });
        Self {
            name: shader.name,
            pipeline: pipeline(gpu, shader, &layout),
            layout,
        }
    }

    /// Resources in the order of what the pass reads.
    pub(crate) fn bind(
        &self,
        gpu: &Gpu,
        resources: &[(u32, wgpu::BindingResource<'_>)],
    ) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = resources
            .iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry {
                binding: *binding,
                resource: resource.clone(),
            })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// Orders the pass over the whole of `target`.
    pub(crate) fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &wgpu::BindGroup,
        target: &wgpu::TextureView,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bound, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// A buffer of `bytes` that is written from the CPU.
pub(crate) fn buffer(
    gpu: &Gpu,
    label: &'static str,
    bytes: u64,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn pipeline(gpu: &Gpu, shader: &Shader, layout: &wgpu::BindGroupLayout) -> wgpu::RenderPipeline {
    let [[vertex, fragment]] = shader.steps else {
        panic!("{} has more than one step", shader.name)
    };
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(shader.name),
            source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
        });
    let layout = gpu
        .device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(shader.name),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
    let targets = [Some(wgpu::ColorTargetState::from(FORMAT))];
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(shader.name),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
}
