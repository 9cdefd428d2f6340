//! How much of the view would each unit refine?
//!
//! An image of units, drawn smaller than what is shown, is added up on the GPU.

use crate::error::RenderError;
use crate::gpu::buffers::{storage, written};
use crate::gpu::compute::{Compute, record};
use crate::gpu::device::Gpu;
use crate::gpu::readback::BytesBack;
use crate::scene::params::in_view;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use foveal_core::pack::unit::UnitId;
use foveal_core::perception::footprints::{Footprint, PARTS_OF_DEG2};
use foveal_core::perception::glance::Glance;
use foveal_core::units::Radians;
use foveal_core::view::eye_view::EyeView;

/// Pixels along the larger side of an image that is added up.
const MOST_SIDE: u32 = 640;
/// Pixels of the display that one of its pixels stands for on a side, at least.
const LEAST_SHARE: u32 = 2;
/// Largest angle that is reported, in sixteenths of a degree.
pub(crate) const MOST_ANGLE: u32 = 4095;
/// Texels on a side of a workgroup.
const WORKGROUP: [u32; 2] = [8, 8];

/// What is added up of one unit, as the shader says.
pub(crate) type FootprintSums = [u32; 4];

/// Where the gaze is in a view.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GazedParams {
    /// Tangents of the field of view to the left, right, up and down, at the eye.
    pub field: [f32; 4],
    /// Unit direction of the gaze in view space, at the eye: right, down, forward.
    pub gaze: [f32; 3],
    /// Keeps the size a multiple of sixteen.
    pub unused: f32,
}

impl GazedParams {
    /// The gaze of a glance through this view.
    #[must_use]
    pub fn new(glance: &Glance, view: &EyeView) -> Self {
        let seen = view.as_seen();
        let gaze = glance.gaze.gaze_in_content;
        let gaze = view.seen_direction(gaze).unwrap_or(gaze);
        let field = seen.field;
        let tangents = [field.left, field.right, field.up, field.down];
        Self {
            field: tangents.map(|it| it as f32),
            gaze: in_view(&seen, gaze).as_vec3().to_array(),
            unused: 0.0,
        }
    }
}

/// The same view with so few pixels that adding them up costs little.
#[must_use]
pub fn small_view(view: &EyeView) -> EyeView {
    let side = view.size[0].max(view.size[1]);
    let share = side.div_ceil(MOST_SIDE).max(LEAST_SHARE);
    EyeView {
        size: view.size.map(|side| side.div_ceil(share)),
        ..*view
    }
}

/// Adds up images of units.
pub(crate) struct FootprintPass {
    compute: Compute,
    params: wgpu::Buffer,
    sums: wgpu::Buffer,
}

/// The sums of one view, on their way.
pub struct FootprintsBack {
    bytes: BytesBack,
    pixel_deg2: f64,
}

impl FootprintPass {
    /// A pass over units with numbers below `units`.
    ///
    /// # Errors
    /// The device binds no buffer that is so large.
    pub(crate) fn new(gpu: &Gpu, units: u32) -> Result<Self, RenderError> {
        let bytes = u64::from(units.max(1)) * size_of::<FootprintSums>() as u64;
        let params = size_of::<GazedParams>() as u64;
        Ok(Self {
            compute: Compute::new(gpu, &shaders::footprints()),
            params: written(gpu, "gaze in a view", params, wgpu::BufferUsages::UNIFORM),
            sums: storage(gpu, "footprints of units", bytes)?,
        })
    }

    /// Adds up the image of units that `view` shows, which has been submitted.
    pub(crate) fn add_up(
        &self,
        gpu: &Gpu,
        image: &wgpu::Texture,
        params: &GazedParams,
    ) -> FootprintsBack {
        let queue = &gpu.queue;
        queue.write_buffer(&self.params, 0, bytemuck::bytes_of(params));
        let image_view = image.create_view(&wgpu::TextureViewDescriptor::default());
        let bindings = [
            (0, self.params.as_entire_binding()),
            (1, wgpu::BindingResource::TextureView(&image_view)),
            (2, self.sums.as_entire_binding()),
        ];
        let size = [image.width(), image.height()];
        let dispatch = self.compute.over(gpu, size, WORKGROUP, &bindings);
        let mut encoder = gpu.encoder("footprints");
        encoder.clear_buffer(&self.sums, 0, None);
        record(&mut encoder, "footprints", None, [&dispatch]);
        let back = BytesBack::buffer(gpu, self.sums.size());
        encoder.copy_buffer_to_buffer(&self.sums, 0, &back, 0, self.sums.size());
        gpu.submit(encoder);
        FootprintsBack {
            bytes: BytesBack::map(back),
            pixel_deg2: pixel_deg2(params, size),
        }
    }
}

impl FootprintsBack {
    /// The footprints, once they are there.
    ///
    /// # Errors
    /// The device was lost on the way.
    pub async fn list(self) -> Result<Vec<Footprint>, RenderError> {
        let bytes = self.bytes.await?;
        let sums: Vec<FootprintSums> = bytemuck::pod_collect_to_vec(&bytes);
        Ok(footprints_of(&sums, self.pixel_deg2))
    }
}

/// Square degrees at the eye that the pixel straight ahead fills, of an image of this size.
pub(crate) fn pixel_deg2(params: &GazedParams, size: [u32; 2]) -> f64 {
    let [left, right, up, down] = params.field.map(f64::from);
    let across = (left + right) / f64::from(size[0]);
    let along = (up + down) / f64::from(size[1]);
    across * along * Radians(1.0).to_degrees().powi(2)
}

/// What such sums say of units, in their order.
pub(crate) fn footprints_of(sums: &[FootprintSums], pixel_deg2: f64) -> Vec<Footprint> {
    let seen = (0..).zip(sums).filter(|(_, [_, pixels, ..])| *pixels > 0);
    let footprint = |(unit, [parts, pixels, angles, nearness]): (u32, &FootprintSums)| {
        let area = f64::from(*parts) / 64.0 * pixel_deg2 * PARTS_OF_DEG2;
        Footprint {
            unit: UnitId(unit),
            area: (area.round() as u32).max(1),
            least: MOST_ANGLE - nearness.min(&MOST_ANGLE),
            mean: angles / pixels,
        }
    };
    seen.map(footprint).collect()
}
