//! How are points drawn?

use crate::gpu::bindings::bind;
use crate::gpu::device::Gpu;
use crate::scene::phase::{Phase, nearest_pipeline};
use crate::shaders;

/// Which bindings there are, and whether one is a uniform.
const BINDINGS: [(u32, bool); 5] = [(0, true), (3, false), (4, false), (5, false), (6, true)];

/// What draws points.
pub(crate) struct PointPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl PointPass {
    /// What draws this.
    pub(crate) fn new(gpu: &Gpu, phase: Phase) -> Self {
        let entries = BINDINGS.map(entry);
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("points"),
                entries: &entries,
            });
        Self {
            pipeline: nearest_pipeline(gpu, &shaders::draw_points(), &layout, phase, None),
            layout,
        }
    }

    /// Binds what is drawn with: view, cubes, blocks, points, and the view's pixels.
    pub(crate) fn bind(&self, gpu: &Gpu, buffers: [&wgpu::Buffer; 5]) -> wgpu::BindGroup {
        let numbers = BINDINGS.iter().map(|(number, _)| *number);
        let resources = numbers.zip(buffers.map(wgpu::Buffer::as_entire_binding));
        bind(gpu, "points", &self.layout, &resources.collect::<Vec<_>>())
    }

    /// Draws so many corners.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        bound: &wgpu::BindGroup,
        corners: u32,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bound, &[]);
        pass.draw(0..corners, 0..1);
    }
}

fn entry((binding, is_uniform): (u32, bool)) -> wgpu::BindGroupLayoutEntry {
    let ty = match is_uniform {
        true => wgpu::BufferBindingType::Uniform,
        false => wgpu::BufferBindingType::Storage { read_only: true },
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}
