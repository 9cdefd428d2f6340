//! What lies on the device between the passes?

use crate::score::constants::{COARSE_BAND_GAIN, LUMINANCE_WEIGHTS};
use crate::score::display::Display;
use crate::score::error::ScoreError;
use crate::score::fast::{BandEye, GazeRay, Table};
use crate::score::pyramid::{half_size, samples_beyond};
use crate::score::rules::GeometryRule;
use crate::score::viewing::Viewing;
use foveal_render::gpu::buffers;
use foveal_render::gpu::compute::{Compute, Dispatch};
use foveal_render::{Gpu, RenderError};

/// Pixels on a side that a workgroup does.
pub(super) const TILE: usize = 16;
/// Numbers that a workgroup of `band` leaves.
pub(super) const SUMS_A_GROUP: usize = 9;

/// Two levels, as the shaders have them.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Level {
    pub(super) fine: [u32; 2],
    pub(super) coarse: [u32; 2],
    beyond: u32,
    even: u32,
    gain: f32,
    pub(super) first_sum: u32,
}

/// A frame of some age.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Tap {
    pub(super) weights: [f32; 2],
    pub(super) is_first: u32,
    pub(super) spare: u32,
}

/// An eye that looks.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct EyeUniform {
    place: [f32; 2],
    length: f32,
    foveated: u32,
    true_rays: u32,
    luminances: u32,
    frequencies: u32,
    raises: u32,
    luminance: [f32; 2],
    root: [f32; 2],
    most: [f32; 2],
    keeps_heat: u32,
    spare: u32,
}

impl EyeUniform {
    pub(super) fn new(
        viewing: &Viewing,
        table: &Table,
        looking: &GazeRay,
        keeps_heat: bool,
    ) -> Self {
        Self {
            place: looking.place,
            length: looking.length,
            foveated: u32::from(viewing.foveated),
            true_rays: u32::from(viewing.rules.geometry == GeometryRule::TrueRays),
            luminances: table.luminances as u32,
            frequencies: table.frequencies as u32,
            raises: u32::from(!table.raised.is_empty()),
            luminance: table.luminance,
            root: [table.root, table.most_root],
            most: [table.most_luminance, table.most_frequency],
            keeps_heat: u32::from(keeps_heat),
            spare: 0,
        }
    }
}

impl Level {
    /// The levels of every band, whose sums lie one after the other.
    pub(super) fn of_bands(viewing: &Viewing, eyes: &[BandEye]) -> Vec<Self> {
        let mut first_sum = 0;
        let levels = eyes.iter().enumerate().map(|(band, eye)| {
            let level = Self {
                fine: eye.size.map(|side| side as u32),
                coarse: half_size(eye.size).map(|side| side as u32),
                beyond: samples_beyond(eye.size, viewing.rules.border) as u32,
                even: u32::from(eye.frequency.len() == 1),
                gain: if band == 0 {
                    1.0
                } else {
                    COARSE_BAND_GAIN as f32
                },
                first_sum,
            };
            first_sum += groups(level.fine).into_iter().product::<u32>();
            level
        });
        levels.collect()
    }
}

/// Workgroups across and down.
pub(super) fn groups(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(TILE as u32))
}

/// Light of the codes of red, of green and of blue, weighed.
pub(super) fn light_of_codes(display: &Display) -> Vec<f32> {
    let of = |weight: f64| {
        (0..=255).map(move |code| (display.light(f64::from(code) / 255.0) * weight) as f32)
    };
    LUMINANCE_WEIGHTS.into_iter().flat_map(of).collect()
}

/// A storage buffer of `bytes`, or some more, filled with zeros.
pub(super) fn storage(
    gpu: &Gpu,
    what: &'static str,
    bytes: u64,
) -> Result<wgpu::Buffer, ScoreError> {
    // Shaders read some planes by four numbers.
    let whole = bytes.next_multiple_of(16).max(16);
    buffers::storage(gpu, what, whole).map_err(refused)
}

/// A storage buffer that holds numbers.
pub(super) fn of_numbers(
    gpu: &Gpu,
    what: &'static str,
    numbers: &[f32],
) -> Result<wgpu::Buffer, ScoreError> {
    let buffer = storage(gpu, what, numbers.len() as u64 * 4)?;
    gpu.queue
        .write_buffer(&buffer, 0, bytemuck::cast_slice(numbers));
    Ok(buffer)
}

/// A uniform buffer that holds a value.
pub(super) fn uniform<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    what: &'static str,
    value: &T,
) -> wgpu::Buffer {
    buffers::filled(gpu, what, wgpu::BufferUsages::UNIFORM, &[*value])
}

/// The pass over buffers in the order of their bindings, for `size` pixels.
pub(super) fn over(
    pass: &Compute,
    gpu: &Gpu,
    size: [u32; 2],
    buffers: &[&wgpu::Buffer],
) -> Dispatch {
    let bindings = buffers.iter().map(|buffer| buffer.as_entire_binding());
    let bindings: Vec<_> = (0..).zip(bindings).collect();
    pass.over(gpu, size, [TILE as u32; 2], &bindings)
}

/// What the device said, in words of the score.
pub(super) fn refused(error: RenderError) -> ScoreError {
    ScoreError::Device(match error {
        RenderError::TooMuch { what, bytes, most } => {
            format!("{what}: {bytes} bytes, of which the device binds {most}")
        }
        RenderError::ReadBack(reason) => format!("the device failed: {reason}"),
        other => other.to_string(),
    })
}
