//! How is a pass drawn?

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::params::{Overlay, ViewParams};
use crate::shaders::Shader;
use crate::tiles::store::TileStore;

/// Format of every picture drawn.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth16Unorm;

/// What passes draw on: a picture, and which of its pixels are drawn already.
pub(crate) struct Target {
    pub(crate) picture: wgpu::Texture,
    views: [wgpu::TextureView; 2],
}

impl Target {
    /// A target of `size` pixels, each at least 1.
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        Self::with_mips(gpu, size, 1)
    }

    /// A target whose picture has room for so many halves, itself the first.
    pub(crate) fn with_mips(gpu: &Gpu, size: [u32; 2], mips: u32) -> Self {
        let texture = |format, usage, mip_level_count| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let read = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        let picture = texture(FORMAT, read, mips);
        let depth = texture(DEPTH_FORMAT, wgpu::TextureUsages::empty(), 1);
        let drawn_on = wgpu::TextureViewDescriptor {
            mip_level_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        };
        let views = [&picture, &depth].map(|t| t.create_view(&drawn_on));
        Self { picture, views }
    }

    /// What is drawn on, and read by passes after it.
    pub(crate) fn picture_view(&self) -> &wgpu::TextureView {
        &self.views[0]
    }

    /// All of it.
    pub(crate) fn whole(&self) -> Area<'_> {
        let [width, height] = self.size();
        self.within([0, 0, width, height])
    }

    /// Left, top, width and height of it.
    pub(crate) fn within(&self, within: [u32; 4]) -> Area<'_> {
        Area {
            target: self,
            within,
        }
    }

    /// Makes the target `size` pixels, at least 1 on a side; refuses what the device cannot draw.
    pub(crate) fn fit(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<(), RenderError> {
        let size = size.map(|side| side.max(1));
        let (side, most) = (
            size[0].max(size[1]),
            gpu.device.limits().max_texture_dimension_2d,
        );
        if side > most {
            let what = "the picture";
            return Err(RenderError::TooLarge { what, side, most });
        }
        if self.size() != size {
            *self = Self::new(gpu, size);
        }
        Ok(())
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.picture.width(), self.picture.height()]
    }
}

/// Which pixels of a target a pass draws; one that replaces the picture leaves the others black.
#[derive(Clone, Copy)]
pub(crate) struct Area<'a> {
    target: &'a Target,
    /// Left, top, width, height.
    within: [u32; 4],
}

/// A full-screen pass over the resident tiles, with its own parameters.
pub(crate) struct Pass {
    name: &'static str,
    steps: Vec<wgpu::RenderPipeline>,
    layout: wgpu::BindGroupLayout,
    view: wgpu::Buffer,
    marks: Option<wgpu::Buffer>,
    bound: Option<(u64, wgpu::BindGroup)>,
}

impl Pass {
    /// A pass that replaces the picture.
    pub(crate) fn new(gpu: &Gpu, shader: &Shader) -> Self {
        Self::build(gpu, shader, None)
    }

    /// A pass that blends over the picture and takes [`Overlay`] parameters.
    pub(crate) fn over(gpu: &Gpu, shader: &Shader) -> Self {
        let mut blend = wgpu::BlendState::ALPHA_BLENDING;
        // The picture stays opaque whatever is drawn over it.
        blend.alpha = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Zero,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        Self::build(gpu, shader, Some(blend))
    }

    fn build(gpu: &Gpu, shader: &Shader, blend: Option<wgpu::BlendState>) -> Self {
        let has_marks = blend.is_some();
        let layout = layout(gpu, has_marks);
        let module = gpu
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
            });
        let step = |entries| pipeline(gpu, &module, &layout, entries, blend);
        let uniform = |size: usize| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(shader.name),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Self {
            name: shader.name,
            steps: shader.steps.iter().map(step).collect(),
            view: uniform(size_of::<ViewParams>()),
            marks: has_marks.then(|| uniform(size_of::<Overlay>())),
            layout,
            bound: None,
        }
    }

    /// Orders the pass over an area.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        tiles: &TileStore,
        Area { target, within }: Area<'_>,
        view: &ViewParams,
        marks: Option<&Overlay>,
    ) {
        gpu.queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(view));
        if let (Some(buffer), Some(marks)) = (&self.marks, marks) {
            gpu.queue.write_buffer(buffer, 0, bytemuck::bytes_of(marks));
        }
        if self
            .bound
            .as_ref()
            .is_none_or(|(bound, _)| *bound != tiles.generation())
        {
            self.bound = Some((tiles.generation(), self.bind(gpu, tiles)));
        }
        let load = match self.marks {
            Some(_) => wgpu::LoadOp::Load,
            None => wgpu::LoadOp::Clear(wgpu::Color::BLACK),
        };
        let [picture, depth] = &target.views;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: picture,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        let [left, top, width, height] = within;
        pass.set_scissor_rect(left, top, width, height);
        pass.set_bind_group(0, self.bound.as_ref().map(|(_, group)| group), &[]);
        for step in &self.steps {
            pass.set_pipeline(step);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }

    fn bind(&self, gpu: &Gpu, tiles: &TileStore) -> wgpu::BindGroup {
        let (buffers, textures) = tiles.bindings();
        let mut resources: Vec<wgpu::BindingResource<'_>> = Vec::new();
        resources.extend(buffers.map(wgpu::Buffer::as_entire_binding));
        resources.extend(textures.iter().map(wgpu::BindingResource::TextureView));
        resources.push(self.view.as_entire_binding());
        resources.extend(self.marks.as_ref().map(wgpu::Buffer::as_entire_binding));
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.layout,
            entries: &entries,
        })
    }
}

fn pipeline(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    layout: &wgpu::BindGroupLayout,
    [vertex, fragment]: &[&'static str; 2],
    blend: Option<wgpu::BlendState>,
) -> wgpu::RenderPipeline {
    let layout = gpu
        .device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(fragment),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: FORMAT,
                    blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
}

/// The bindings of `shaders/shared/tiles.wgsl`, then the view, then the marks.
fn layout(gpu: &Gpu, has_marks: bool) -> wgpu::BindGroupLayout {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let uniform = buffer(wgpu::BufferBindingType::Uniform);
    let storage = buffer(wgpu::BufferBindingType::Storage { read_only: true });
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    };
    let mut types = vec![uniform, storage, texture, texture, uniform];
    types.extend(has_marks.then_some(uniform));
    let entries: Vec<wgpu::BindGroupLayoutEntry> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("tiles and view"),
            entries: &entries,
        })
}
