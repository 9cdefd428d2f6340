//! What draws panels: a GPU, or the twin of its pass?

use crate::commands::panels::filter_name::FilterName;
use crate::options::renderer::{RendererName, open_device};
use crate::report::output::{WrongUsage, say};
use anyhow::bail;
use foveal_render::twin::{self, TwinSource};
use foveal_render::warp::{LoadedPlan, SourceTexture, WarpPlan, WarpStyle, Warper};
use foveal_render::{DrawDevice, Gpu, RgbaImage};

/// What draws a plan, frame after frame.
pub(super) enum WarpDevice {
    Gpu(Box<OnGpu>),
    /// The twin draws; whether by the elliptical weighted average.
    Twin {
        plan: WarpPlan,
        style: WarpStyle,
        by_ewa: bool,
    },
}

pub(super) struct OnGpu {
    gpu: Gpu,
    warper: Warper,
    plan: LoadedPlan,
    source: SourceTexture,
    style: WarpStyle,
}

/// What draws by a filter.
pub(super) fn opened(renderer: RendererName, filter: FilterName) -> anyhow::Result<DrawDevice> {
    if filter == FilterName::Ewa {
        say("ewa is drawn on the CPU: it is what the other filters are judged by, and slow");
        return Ok(DrawDevice::Twin);
    }
    match open_device(renderer)? {
        DrawDevice::Nothing => bail!(WrongUsage(
            "--renderer none: panels are drawn here; give gpu or cpu".to_owned()
        )),
        device => Ok(device),
    }
}

/// Most pixels of a side of a source.
pub(super) fn most_side(device: &DrawDevice) -> u32 {
    match device {
        DrawDevice::Gpu(gpu) => most_side_of(gpu),
        DrawDevice::Twin | DrawDevice::Nothing => u32::MAX,
    }
}

pub(super) fn most_side_of(gpu: &Gpu) -> u32 {
    gpu.device.limits().max_texture_dimension_2d
}

impl WarpDevice {
    /// A device with a plan, for sources of `size`.
    pub(super) fn new(
        device: &DrawDevice,
        plan: WarpPlan,
        size: [u32; 2],
        (filter, paints): (FilterName, bool),
    ) -> anyhow::Result<Self> {
        let style = WarpStyle {
            filter: filter.of_pass().unwrap_or_default(),
            paints,
        };
        Ok(match device {
            DrawDevice::Gpu(gpu) => {
                let warper = Warper::new(gpu);
                let needs_levels = style.filter.reads_levels();
                Self::Gpu(Box::new(OnGpu {
                    plan: warper.load(&plan)?,
                    source: SourceTexture::new(gpu, size, needs_levels)?,
                    warper,
                    gpu: gpu.clone(),
                    style,
                }))
            }
            DrawDevice::Twin | DrawDevice::Nothing => Self::Twin {
                plan,
                style,
                by_ewa: filter == FilterName::Ewa,
            },
        })
    }

    /// The atlas, filled from a picture.
    pub(super) fn fill(&self, picture: &RgbaImage) -> anyhow::Result<RgbaImage> {
        match self {
            Self::Gpu(it) => {
                it.source.write(&it.gpu, picture)?;
                let read = it.warper.read(&it.plan, &it.source, &it.style);
                Ok(read.wait(&it.gpu)?)
            }
            Self::Twin {
                plan,
                style,
                by_ewa,
            } => {
                let source = TwinSource::new(picture, style.filter.reads_levels() && !by_ewa);
                Ok(match by_ewa {
                    true => twin::warp_by_ewa(&source, plan),
                    false => twin::warp(&source, plan, style),
                })
            }
        }
    }

    pub(super) fn name(&self) -> &str {
        match self {
            Self::Gpu(it) => it.gpu.adapter_name(),
            Self::Twin { .. } => "the CPU twin",
        }
    }
}
