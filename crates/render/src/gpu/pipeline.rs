//! How does a step of a shader become a pipeline?

use crate::gpu::device::Gpu;

/// How a step draws.
pub(crate) struct Drawing<'a> {
    /// What is bound in group 0; what the shader's text says where there is none.
    pub(crate) layout: Option<&'a wgpu::BindGroupLayout>,
    pub(crate) primitive: wgpu::PrimitiveState,
    pub(crate) depth: Option<wgpu::DepthStencilState>,
    pub(crate) target: wgpu::ColorTargetState,
    /// Constants of the fragment entry.
    pub(crate) constants: &'a [(&'a str, f64)],
}

/// The text of a shader, compiled.
pub(crate) fn module(gpu: &Gpu, name: &str, text: &str) -> wgpu::ShaderModule {
    gpu.device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        })
}

/// The pipeline of a vertex and a fragment entry.
pub(crate) fn pipeline(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&'static str; 2],
    drawing: Drawing<'_>,
) -> wgpu::RenderPipeline {
    let device = &gpu.device;
    let layout = drawing.layout.map(|layout| {
        device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(fragment),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        })
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: layout.as_ref(),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: drawing.primitive,
        depth_stencil: drawing.depth,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: drawing.constants,
                ..wgpu::PipelineCompilationOptions::default()
            },
            targets: &[Some(drawing.target)],
        }),
        multiview_mask: None,
        cache: None,
    })
}
