//! In which phases is a scene drawn, and by what pipelines?

use crate::gpu::device::Gpu;
use crate::gpu::picture_target::FORMAT;
use crate::gpu::pipeline::{Drawing, module, pipeline};
use crate::shaders::Shader;

/// Format of the depths of clusters: the nearest is the largest, so that single precision
/// distinguishes depths as well near as far.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of an image of units.
pub(crate) const UNITS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// What is drawn of a scene's units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Colours of what hides all behind it.
    Opaque,
    /// Colours of what covers a share of what is behind it, after all that is opaque.
    Transparent,
    /// The units that would refine what is seen.
    Ids,
}

impl Phase {
    /// The phases of a picture that is drawn for this one, in order.
    pub(crate) fn all(self) -> &'static [Self] {
        match self {
            Self::Opaque | Self::Transparent => &[Self::Opaque, Self::Transparent],
            Self::Ids => &[Self::Ids],
        }
    }
}

/// A part of a picture's drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Go {
    /// All of it.
    Only,
    /// What hides others: what the picture before did not hide.
    First,
    /// Everything else.
    Second,
}

/// A pipeline of a shader that draws what is nearest to the eye: colours in its first step, units
/// that would refine them in its second. What is transparent hides nothing.
pub(crate) fn nearest_pipeline(
    gpu: &Gpu,
    shader: &Shader,
    layout: &wgpu::BindGroupLayout,
    phase: Phase,
    cull_mode: Option<wgpu::Face>,
) -> wgpu::RenderPipeline {
    let (step, format) = match phase {
        Phase::Opaque | Phase::Transparent => (0, FORMAT),
        Phase::Ids => (1, UNITS_FORMAT),
    };
    let is_transparent = phase == Phase::Transparent;
    let drawing = Drawing {
        layout: Some(layout),
        primitive: wgpu::PrimitiveState {
            cull_mode,
            ..wgpu::PrimitiveState::default()
        },
        depth: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(!is_transparent),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        target: wgpu::ColorTargetState {
            format,
            blend: is_transparent.then_some(wgpu::BlendState::ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        },
        constants: &[],
    };
    let module = module(gpu, shader.name, &shader.text);
    pipeline(gpu, &module, shader.steps[step], drawing)
}
