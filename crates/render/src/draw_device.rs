//! What draws, and where is the picture then?

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::readback::ReadBack;
use crate::image::RgbaImage;

/// What draws, ready: one can serve several drawers.
#[derive(Clone)]
pub enum DrawDevice {
    /// A graphics device, or a software driver in its place.
    Gpu(Gpu),
    /// The plain CPU twin of the GPU's passes.
    Twin,
    /// Draws nothing.
    Nothing,
}

impl DrawDevice {
    /// Its name, for people.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Gpu(gpu) => gpu.adapter_name(),
            Self::Twin => "the CPU twin",
            Self::Nothing => "nothing",
        }
    }
}

/// A picture that was drawn, on its way to main memory.
pub enum DrawnPicture {
    /// It is there.
    Here(RgbaImage),
    /// The GPU still sends it.
    Coming(ReadBack),
}

impl DrawnPicture {
    /// The picture, once it is there.
    ///
    /// # Errors
    /// The device was lost on the way.
    pub async fn image(self) -> Result<RgbaImage, RenderError> {
        match self {
            Self::Here(image) => Ok(image),
            Self::Coming(read) => read.await,
        }
    }
}
