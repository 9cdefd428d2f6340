//! Which colour has what is lost at a pixel?

use crate::fire::fire;
use crate::picture_file::write_png;
use foveal_eval::score::fast::HeatMap;
use foveal_render::RgbaImage;
use std::path::Path;

/// What is shown in the lightest colour, JOD lost: the same in every picture, so that two can be
/// compared.
const LIGHTEST_JOD: f32 = 5.0;

/// Writes a heat map as PNG: black is nothing lost, then violet, orange and light yellow.
pub(crate) fn write_heat(path: &Path, heat: &HeatMap) -> anyhow::Result<()> {
    let mut image = RgbaImage::black(heat.size);
    for (pixel, lost) in image.pixels.chunks_exact_mut(4).zip(&heat.jod_lost) {
        // The root keeps what is small in sight.
        pixel[..3].copy_from_slice(&fire((lost / LIGHTEST_JOD).sqrt()));
    }
    write_png(path, &image)
}
