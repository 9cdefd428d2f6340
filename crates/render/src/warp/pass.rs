//! How are all panels of a plan drawn at once?

use super::batches::{batches, records};
use super::params::{MOST_PROBES, WarpParams};
use super::plan::WarpPlan;
use super::source::{SOURCE_FORMAT, SourceTexture};
use super::style::{WarpFilter, WarpStyle};
use crate::error::RenderError;
use crate::gpu::bindings::bind;
use crate::gpu::buffers::{storage, written};
use crate::gpu::device::Gpu;
use crate::gpu::picture_target::check_size;
use crate::gpu::pipeline::{Drawing, module, pipeline};
use crate::gpu::readback::{PictureCopy, ReadBack};
use crate::gpu::textures::texture_array;
use crate::gpu::timer::Timer;
use crate::shaders::{Shader, reduce_source, warp};
use std::cell::OnceCell;
use std::ops::Range;

/// Draws plans: one pass into one atlas, and before it one for each coarser level of a source.
pub struct Warper {
    gpu: Gpu,
    /// By the number of the filter, once it was drawn with: for sharp eyes, and for one that
    /// blurs.
    fill: [[OnceCell<wgpu::RenderPipeline>; WarpFilter::ALL.len()]; 2],
    reduce: wgpu::RenderPipeline,
    between: wgpu::Sampler,
    along: wgpu::Sampler,
    params: wgpu::Buffer,
    /// Whether the device's own anisotropic filter is taken.
    by_device: bool,
    /// What atlases are made of.
    format: wgpu::TextureFormat,
}

/// A plan on the GPU, and the atlas that it fills.
pub struct LoadedPlan {
    atlas: wgpu::Texture,
    view: wgpu::TextureView,
    /// Records, blends, neighbours, sights and fields.
    buffers: [wgpu::Buffer; 5],
    /// Panels that are drawn together, and their grids.
    batches: Vec<(Range<u32>, wgpu::Buffer)>,
    spread: [f32; 2],
}

impl Warper {
    /// Builds the passes.
    #[must_use]
    pub fn new(gpu: &Gpu) -> Self {
        Self::onto(gpu, SOURCE_FORMAT)
    }

    /// The same for atlases, or windows, of a format of sRGB codes.
    #[must_use]
    pub fn onto(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let sampler = |anisotropy_clamp| {
            gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("source"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                anisotropy_clamp,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        let usage = wgpu::BufferUsages::UNIFORM;
        let by_device = filters_along(gpu);
        Self {
            gpu: gpu.clone(),
            fill: Default::default(),
            reduce: pipeline_of(
                gpu,
                &reduce_source(),
                SOURCE_FORMAT,
                (wgpu::PrimitiveTopology::TriangleList, &[]),
            ),
            between: sampler(1),
            along: sampler(if by_device { MOST_PROBES } else { 1 }),
            by_device,
            format,
            params: written(gpu, "warp", size_of::<WarpParams>() as u64, usage),
        }
    }

    /// Uploads a plan and makes its atlas.
    ///
    /// # Errors
    /// The atlas is larger than the device draws, or the grid of one panel larger than it binds, or
    /// its memory has no room for them.
    pub fn load(&self, plan: &WarpPlan) -> Result<LoadedPlan, RenderError> {
        let gpu = &self.gpu;
        check_buffers(gpu)?;
        let size = plan.atlas.map(|side| side.max(1));
        check_size(gpu, size)?;
        let bytes = 4 * u64::from(size[0]) * u64::from(size[1]);
        let atlas = gpu.roomed(("the picture of all panels", bytes), |device| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::TEXTURE_BINDING;
            texture_array(
                device,
                "panels",
                [size[0], size[1], 1, 1],
                self.format,
                usage,
            )
        })?;
        let held = |what, bytes: &[u8]| {
            // A binding holds one record at least.
            let buffer = storage(gpu, what, (bytes.len() as u64).max(128))?;
            gpu.queue.write_buffer(&buffer, 0, bytes);
            Ok::<_, RenderError>(buffer)
        };
        let batches = batches(plan, gpu.device.limits().max_storage_buffer_binding_size);
        let records = records(plan, &batches);
        let grids = batches.into_iter().map(|it| {
            let words = bytemuck::cast_slice(&plan.grids[it.words]);
            Ok((it.panels, held("the maps of a panel", words)?))
        });
        Ok(LoadedPlan {
            view: atlas.create_view(&wgpu::TextureViewDescriptor::default()),
            atlas,
            batches: grids.collect::<Result<_, RenderError>>()?,
            buffers: [
                held("records of panels", bytemuck::cast_slice(&records))?,
                held("blends", bytemuck::cast_slice(&plan.blends))?,
                held("neighbours", bytemuck::cast_slice(&plan.neighbours))?,
                held("sights", bytemuck::cast_slice(&plan.sights))?,
                held("fades", bytemuck::cast_slice(&plan.fields))?,
            ],
            spread: plan.spread,
        })
    }

    /// Fills all panels; returns the texture of codes that they are sent.
    pub fn draw<'a>(
        &self,
        plan: &'a LoadedPlan,
        source: &SourceTexture,
        style: &WarpStyle,
    ) -> &'a wgpu::Texture {
        let mut encoder = self.gpu.encoder("panels");
        self.record(&mut encoder, plan, source, style, None);
        self.gpu.submit(encoder);
        &plan.atlas
    }

    /// [`Self::draw`], with the atlas on its way back to the CPU.
    #[must_use]
    pub fn read(&self, plan: &LoadedPlan, source: &SourceTexture, style: &WarpStyle) -> ReadBack {
        let mut encoder = self.gpu.encoder("panels to read");
        self.record(&mut encoder, plan, source, style, None);
        let copy = PictureCopy::record(&self.gpu, &mut encoder, &plan.atlas);
        self.gpu.submit(encoder);
        copy.map()
    }

    /// Records the source's coarser levels and the pass that fills all panels; the pass alone is
    /// stamped by `timer`.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        plan: &LoadedPlan,
        source: &SourceTexture,
        style: &WarpStyle,
        timer: Option<&Timer>,
    ) {
        let size = [plan.atlas.width(), plan.atlas.height()];
        self.record_onto(encoder, plan, source, style, (&plan.view, size, timer));
    }

    /// The same onto another texture of so many columns and rows, which is the atlas then.
    pub fn record_onto(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        plan: &LoadedPlan,
        source: &SourceTexture,
        style: &WarpStyle,
        (target, size, timer): (&wgpu::TextureView, [u32; 2], Option<&Timer>),
    ) {
        let levels = source.texture.mip_level_count();
        let params = WarpParams {
            by_device: u32::from(self.by_device),
            ..WarpParams::new(size, levels, style)
        };
        let params = params.blurred(plan.spread, style.filter.moment());
        self.gpu
            .queue
            .write_buffer(&self.params, 0, bytemuck::bytes_of(&params));
        let blurs = params.blurs();
        let fill = self.fill[usize::from(blurs)][params.filter_by as usize].get_or_init(|| {
            let constants = [
                ("pipeline_filter", f64::from(params.filter_by)),
                ("pipeline_blurs", f64::from(u8::from(blurs))),
            ];
            let strip = wgpu::PrimitiveTopology::TriangleStrip;
            pipeline_of(&self.gpu, &warp(), self.format, (strip, &constants))
        });
        for pair in source.levels.windows(2) {
            let finer = wgpu::BindingResource::TextureView(&pair[0]);
            let group = self.bound("coarser level", &self.reduce, &[(0, finer)]);
            let mut pass = begin(encoder, "coarser level", &pair[1], None);
            pass.set_pipeline(&self.reduce);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        let whole = source
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = begin(encoder, "panels", target, timer);
        pass.set_pipeline(fill);
        for (range, grids) in &plan.batches {
            let group = self.bound_batch(fill, plan, (grids, &whole));
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..4, range.clone());
        }
    }

    fn bound_batch(
        &self,
        fill: &wgpu::RenderPipeline,
        plan: &LoadedPlan,
        (grids, source): (&wgpu::Buffer, &wgpu::TextureView),
    ) -> wgpu::BindGroup {
        let [panels, blends, neighbours, sights, fields] = &plan.buffers;
        self.bound(
            "panels",
            fill,
            &[
                (0, self.params.as_entire_binding()),
                (1, wgpu::BindingResource::TextureView(source)),
                (2, wgpu::BindingResource::Sampler(&self.between)),
                (3, wgpu::BindingResource::Sampler(&self.along)),
                (4, panels.as_entire_binding()),
                (5, blends.as_entire_binding()),
                (6, neighbours.as_entire_binding()),
                (7, grids.as_entire_binding()),
                (8, sights.as_entire_binding()),
                (9, fields.as_entire_binding()),
            ],
        )
    }

    fn bound(
        &self,
        name: &'static str,
        pipeline: &wgpu::RenderPipeline,
        resources: &[(u32, wgpu::BindingResource<'_>)],
    ) -> wgpu::BindGroup {
        bind(
            &self.gpu,
            name,
            &pipeline.get_bind_group_layout(0),
            resources,
        )
    }
}

/// Refuses a device that gives a shader fewer buffers than the pass reads.
fn check_buffers(gpu: &Gpu) -> Result<(), RenderError> {
    const BUFFERS: u32 = 6;
    let has = gpu.device.limits().max_storage_buffers_per_shader_stage;
    match has >= BUFFERS {
        true => Ok(()),
        false => Err(RenderError::Lacks {
            what: "filling panels",
            limit: "max_storage_buffers_per_shader_stage",
            needs: BUFFERS,
            has,
        }),
    }
}

/// Whether to leave anisotropic filtering to the device: never to software. Mesa's llvmpipe
/// (22.3.6) does filter along the longer axis, but from places up to texels away, with a seam along
/// the diagonal of every quad, and some hundred times slower than by single samples.
fn filters_along(gpu: &Gpu) -> bool {
    gpu.device.adapter_info().device_type != wgpu::DeviceType::Cpu
}

/// Begins a pass on black.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    name: &'static str,
    target: &wgpu::TextureView,
    timer: Option<&Timer>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        timestamp_writes: timer.map(Timer::around_drawing),
        ..wgpu::RenderPassDescriptor::default()
    })
}

fn pipeline_of(
    gpu: &Gpu,
    shader: &Shader,
    format: wgpu::TextureFormat,
    (topology, constants): (wgpu::PrimitiveTopology, &[(&str, f64)]),
) -> wgpu::RenderPipeline {
    let drawing = Drawing {
        layout: None,
        primitive: wgpu::PrimitiveState {
            topology,
            ..wgpu::PrimitiveState::default()
        },
        depth: None,
        target: format.into(),
        constants,
    };
    let module = module(gpu, shader.name, &shader.text);
    pipeline(gpu, &module, shader.steps[0], drawing)
}

impl LoadedPlan {
    /// The atlas that was filled last.
    #[must_use]
    pub fn atlas(&self) -> &wgpu::Texture {
        &self.atlas
    }

    /// Bytes of the atlas, and of what the pass reads besides the source.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        let pixels = u64::from(self.atlas.width()) * u64::from(self.atlas.height());
        let grids = self.batches.iter().map(|it| &it.1);
        let buffers = self.buffers.iter().chain(grids);
        4 * pixels + buffers.map(wgpu::Buffer::size).sum::<u64>()
    }
}
