//! How is the pass recorded that draws clusters?

use crate::gpu::bindings::bind;
use crate::gpu::device::Gpu;
use crate::meshes::lists::DrawList;
use crate::pages::PageLayer;
use crate::scene::phase::{DEPTH_FORMAT, Phase, nearest_pipeline};
use crate::shaders;

/// Stands for no unit in an image of units.
const NO_UNIT: f64 = u32::MAX as f64;
/// What the steps read: the view in front, other buffers, then pages and how they are read.
const BINDINGS: u32 = 8;

/// The pass that draws lists of clusters: the first from outside, the second from both sides.
pub(crate) struct ClusterPass {
    phase: Phase,
    pipelines: [wgpu::RenderPipeline; 2],
    layout: wgpu::BindGroupLayout,
    depth: Option<wgpu::Texture>,
}

impl ClusterPass {
    /// The pass that draws this.
    pub(crate) fn new(gpu: &Gpu, phase: Phase) -> Self {
        let entries: Vec<_> = (0..BINDINGS).map(entry).collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("clusters"),
                entries: &entries,
            });
        Self {
            phase,
            pipelines: pipelines(gpu, &layout, phase),
            layout,
            depth: None,
        }
    }

    /// Binds what a list is drawn with: the view, placements, words and vertices, and pages.
    pub(crate) fn bind(
        &self,
        gpu: &Gpu,
        [view, placements, words, vertices]: [&wgpu::Buffer; 4],
        shown: &wgpu::Buffer,
        pages: &PageLayer,
    ) -> wgpu::BindGroup {
        let (table, atlas, sampler) = pages.bindings();
        let resources = [
            (0, view.as_entire_binding()),
            (1, placements.as_entire_binding()),
            (2, words.as_entire_binding()),
            (3, shown.as_entire_binding()),
            (4, vertices.as_entire_binding()),
            (5, table.as_entire_binding()),
            (6, wgpu::BindingResource::TextureView(&atlas)),
            (7, wgpu::BindingResource::Sampler(sampler)),
        ];
        bind(gpu, "clusters", &self.layout, &resources)
    }

    /// Records a go over a whole picture, of which pixels have these codes where nothing stands:
    /// the first, or the second, which draws into what the first left. `beside` draws into it what
    /// is no cluster.
    pub(crate) fn record(
        &mut self,
        (gpu, encoder): (&Gpu, &mut wgpu::CommandEncoder),
        (picture, background): (&wgpu::Texture, [u8; 4]),
        (go, lists): (usize, [(&DrawList, &wgpu::BindGroup); 2]),
        beside: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let view = picture.create_view(&wgpu::TextureViewDescriptor::default());
        let depth = self.depth_of(gpu, picture.size());
        let clear = match self.phase {
            Phase::Opaque => cleared(background.map(|it| f64::from(it) / 255.0)),
            Phase::Ids => cleared([NO_UNIT; 4]),
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clusters"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: begun(go, clear),
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(begun(go, 0.0)),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        for (pipeline, (list, bound)) in self.pipelines.iter().zip(lists) {
            if list.count() > 0 {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, bound, &[]);
                pass.set_index_buffer(list.corners().slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed_indirect(list.arguments(go), 0);
            }
        }
        beside(&mut pass);
    }

    /// The depths of the picture that was drawn last.
    pub(crate) fn depths(&self) -> Option<wgpu::TextureView> {
        let depth = self.depth.as_ref();
        depth.map(|it| it.create_view(&wgpu::TextureViewDescriptor::default()))
    }

    /// Depths of a picture's size.
    fn depth_of(&mut self, gpu: &Gpu, size: wgpu::Extent3d) -> wgpu::TextureView {
        let fitting = self.depth.take().filter(|it| it.size() == size);
        let depth = fitting.unwrap_or_else(|| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("depths of clusters"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: DEPTH_FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        });
        let view = depth.create_view(&wgpu::TextureViewDescriptor::default());
        self.depth = Some(depth);
        view
    }
}

/// How a go begins: the first with a value everywhere, the second with what the first left.
fn begun<V>(go: usize, value: V) -> wgpu::Operations<V> {
    wgpu::Operations {
        load: match go {
            0 => wgpu::LoadOp::Clear(value),
            _ => wgpu::LoadOp::Load,
        },
        store: wgpu::StoreOp::Store,
    }
}

fn cleared([r, g, b, a]: [f64; 4]) -> wgpu::Color {
    wgpu::Color { r, g, b, a }
}

fn entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let ty = match binding {
        0 => buffer(wgpu::BufferBindingType::Uniform),
        6 => wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        },
        7 => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        _ => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    }
}

/// The pipeline that draws from outside, and the one that draws from both sides.
fn pipelines(gpu: &Gpu, layout: &wgpu::BindGroupLayout, phase: Phase) -> [wgpu::RenderPipeline; 2] {
    let shader = shaders::draw_clusters();
    [Some(wgpu::Face::Back), None]
        .map(|cull_mode| nearest_pipeline(gpu, &shader, layout, phase, cull_mode))
}
