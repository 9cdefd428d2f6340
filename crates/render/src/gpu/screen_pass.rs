//! How is a pass over the screen built and recorded?

use crate::gpu::bindings::bind;
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::{Area, DEPTH_FORMAT, FORMAT};
use crate::gpu::pipeline::{Drawing, module, pipeline};
use crate::shaders::Shader;

/// A pass that draws a triangle over all of a picture, once a step, with bindings of its own.
#[derive(Clone)]
pub(crate) struct ScreenPass {
    name: &'static str,
    steps: Vec<wgpu::RenderPipeline>,
    layout: wgpu::BindGroupLayout,
    /// Whether the picture stays under what is drawn.
    blends: bool,
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
    /// Numbers of units, one by one.
    Units,
}

impl Reads {
    /// Bindings with what each reads, in the stages that read them.
    pub(crate) fn layout(
        gpu: &Gpu,
        name: &'static str,
        visibility: wgpu::ShaderStages,
        reads: &[(u32, Self)],
    ) -> wgpu::BindGroupLayout {
        let entry = |(binding, reads): &(u32, Self)| wgpu::BindGroupLayoutEntry {
            binding: *binding,
            visibility,
            ty: reads.binding(),
            count: None,
        };
        let entries: Vec<wgpu::BindGroupLayoutEntry> = reads.iter().map(entry).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor {
            label: Some(name),
            entries: &entries,
        };
        gpu.device.create_bind_group_layout(&descriptor)
    }

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
            Self::Units => wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Uint,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
        }
    }
}

impl ScreenPass {
    /// A pass that replaces the picture, with what it reads at each binding.
    pub(crate) fn new(gpu: &Gpu, shader: &Shader, reads: &[(u32, Reads)]) -> Self {
        Self::build(gpu, shader, reads, None)
    }

    /// A pass that blends over the picture, with what it reads at each binding.
    pub(crate) fn over(gpu: &Gpu, shader: &Shader, reads: &[(u32, Reads)]) -> Self {
        let mut blend = wgpu::BlendState::ALPHA_BLENDING;
        // The picture stays opaque whatever is drawn over it.
        blend.alpha = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        Self::build(gpu, shader, reads, Some(blend))
    }

    fn build(
        gpu: &Gpu,
        shader: &Shader,
        reads: &[(u32, Reads)],
        blend: Option<wgpu::BlendState>,
    ) -> Self {
        let layout = Reads::layout(gpu, shader.name, wgpu::ShaderStages::FRAGMENT, reads);
        Self {
            name: shader.name,
            steps: pipelines(gpu, shader, &layout, blend),
            layout,
            blends: blend.is_some(),
        }
    }

    /// Resources, each at the number of its binding.
    pub(crate) fn bind(
        &self,
        gpu: &Gpu,
        resources: &[(u32, wgpu::BindingResource<'_>)],
    ) -> wgpu::BindGroup {
        bind(gpu, self.name, &self.layout, resources)
    }

    /// Records the pass over an area, which has a depth where there are several steps.
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        bound: &wgpu::BindGroup,
        area: Area<'_>,
    ) {
        let load = match self.blends {
            true => wgpu::LoadOp::Load,
            false => wgpu::LoadOp::Clear(wgpu::Color::BLACK),
        };
        let depth = area.depth.filter(|_| has_depth(self.steps.len()));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: area.picture,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        if let Some([left, top, width, height]) = area.within {
            pass.set_scissor_rect(left, top, width, height);
        }
        pass.set_bind_group(0, bound, &[]);
        for step in &self.steps {
            pass.set_pipeline(step);
            pass.draw(0..3, 0..1);
        }
    }
}

/// A step after the first leaves what is drawn already, and finds it by its depth.
fn has_depth(steps: usize) -> bool {
    steps > 1
}

/// A pipeline for each step of a shader.
fn pipelines(
    gpu: &Gpu,
    shader: &Shader,
    layout: &wgpu::BindGroupLayout,
    blend: Option<wgpu::BlendState>,
) -> Vec<wgpu::RenderPipeline> {
    let module = module(gpu, shader.name, &shader.text);
    let depth = has_depth(shader.steps.len()).then(|| wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Less),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    });
    let step = |entries: &[&'static str; 2]| {
        let drawing = Drawing {
            layout: Some(layout),
            primitive: wgpu::PrimitiveState::default(),
            depth: depth.clone(),
            target: wgpu::ColorTargetState {
                format: FORMAT,
                blend,
                write_mask: wgpu::ColorWrites::ALL,
            },
            constants: &[],
        };
        pipeline(gpu, &module, *entries, drawing)
    };
    shader.steps.iter().map(step).collect()
}
