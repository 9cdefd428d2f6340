//! `--renderer`: what draws the picture?

use anyhow::Context;
use clap::ValueEnum;
use foveal_render::{DrawDevice, Gpu};

/// Which renderer was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RendererName {
    /// The GPU, or a software Vulkan driver in its place.
    Gpu,
    /// The plain CPU twin of the GPU's passes: slow, needs no driver.
    Cpu,
    /// Draw nothing: only decode.
    None,
}

/// Opens what was asked for.
pub(crate) fn open_device(name: RendererName) -> anyhow::Result<DrawDevice> {
    Ok(match name {
        RendererName::Gpu => {
            let gpu = Gpu::open_blocking();
            DrawDevice::Gpu(gpu.context("no GPU can draw; --renderer cpu needs none")?)
        }
        RendererName::Cpu => DrawDevice::Twin,
        RendererName::None => DrawDevice::Nothing,
    })
}
