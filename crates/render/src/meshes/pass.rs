//! How are clusters drawn?

use crate::gpu::bindings::bind;
use crate::gpu::device::Gpu;
use crate::meshes::lists::DrawList;
use crate::scene::kind::Textures;
use crate::scene::phase::{Phase, nearest_pipeline};
use crate::shaders;

/// What the steps read: the view in front, other buffers, then pages and how they are read.
const BINDINGS: u32 = 8;

/// The pass that draws lists of clusters: the first from outside, the second from both sides.
pub(crate) struct ClusterPass {
    pipelines: [wgpu::RenderPipeline; 2],
    layout: wgpu::BindGroupLayout,
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
            pipelines: pipelines(gpu, &layout, phase),
            layout,
        }
    }

    /// Binds what a list is drawn with: the view, placements, words and vertices, and pages.
    pub(crate) fn bind(
        &self,
        gpu: &Gpu,
        [view, placements, words, vertices]: [&wgpu::Buffer; 4],
        shown: &wgpu::Buffer,
        textures: &Textures,
    ) -> wgpu::BindGroup {
        let resources = [
            (0, view.as_entire_binding()),
            (1, placements.as_entire_binding()),
            (2, words.as_entire_binding()),
            (3, shown.as_entire_binding()),
            (4, vertices.as_entire_binding()),
            (5, textures.table.as_entire_binding()),
            (6, wgpu::BindingResource::TextureView(&textures.pages)),
            (7, wgpu::BindingResource::Sampler(&textures.sampler)),
        ];
        bind(gpu, "clusters", &self.layout, &resources)
    }

    /// Draws what a go found of lists, the first or the second.
    pub(crate) fn draw<'a>(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        go: usize,
        lists: impl Iterator<Item = (&'a DrawList, &'a wgpu::BindGroup)>,
    ) {
        for (pipeline, (list, bound)) in self.pipelines.iter().zip(lists) {
            if list.count() > 0 {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, bound, &[]);
                pass.set_index_buffer(list.corners().slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed_indirect(list.arguments(go), 0);
            }
        }
    }
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
