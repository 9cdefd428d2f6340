//! How are units drawn whose corners a shader places?

use crate::gpu::bindings::bind;
use crate::gpu::device::Gpu;
use crate::scene::phase::{Phase, nearest_pipeline};
use crate::shaders::Shader;

/// Which bindings there are, and whether one is a uniform; all others are storage that is read.
pub type Bindings = &'static [(u32, bool)];

/// What draws the units of a kind from buffers, corner by corner.
pub struct CornerPass {
    name: &'static str,
    bindings: Bindings,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl CornerPass {
    /// What draws a phase by a shader, whose vertex entries read these.
    #[must_use]
    pub fn new(gpu: &Gpu, shader: &Shader, bindings: Bindings, phase: Phase) -> Self {
        let entries: Vec<_> = bindings.iter().map(entry).collect();
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(shader.name),
                entries: &entries,
            });
        Self {
            name: shader.name,
            bindings,
            pipeline: nearest_pipeline(gpu, shader, &layout, phase, None),
            layout,
        }
    }

    /// Binds what is drawn with, in the order of the bindings.
    #[must_use]
    pub fn bind(&self, gpu: &Gpu, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let numbers = self.bindings.iter().map(|(number, _)| *number);
        let resources = buffers.iter().map(|it| it.as_entire_binding());
        let resources: Vec<_> = numbers.zip(resources).collect();
        bind(gpu, self.name, &self.layout, &resources)
    }

    /// Draws so many corners.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bound: &wgpu::BindGroup, corners: u32) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bound, &[]);
        pass.draw(0..corners, 0..1);
    }
}

fn entry((binding, is_uniform): &(u32, bool)) -> wgpu::BindGroupLayoutEntry {
    let ty = match is_uniform {
        true => wgpu::BufferBindingType::Uniform,
        false => wgpu::BufferBindingType::Storage { read_only: true },
    };
    wgpu::BindGroupLayoutEntry {
        binding: *binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}
