//! How is the metric computed on a graphics device?
//!
//! Passes in this order: `luminance`, `temporal` (once for every frame of a quarter of a second),
//! `reduce` and `band` (once for every level), and for a heat map `gather` and `lost`. Their twin
//! is [`super::fast`]. Sums of workgroups come back and are added in their order, in double
//! precision. Shaders use neither subgroups nor half floats, and 8 storage buffers at most.

mod buffers;
mod passes;
mod shaders;

use super::error::ScoreError;
use super::fast::HeatMap;
use super::geometry::Geometry;
use super::picture::{Samples, ScorePicture};
use super::pooling::{FrameScore, Pool, Score};
use super::viewing::Viewing;
use foveal_render::Gpu;
use passes::Passes;
pub use shaders::score_shaders;
use std::time::Duration;

/// Scores frame after frame on a device. Holds the frames of a quarter of a second and about 50
/// bytes a pixel there.
pub struct GpuJudge {
    viewing: Viewing,
    centres: Vec<f64>,
    geometry: Geometry,
    passes: Passes,
    pool: Pool,
    gpu_time: Option<Duration>,
}

impl GpuJudge {
    /// A judge that has seen nothing, on a device with at least WebGPU's default limits, or less
    /// where its adapter has less.
    ///
    /// # Errors
    /// When the device cannot bind buffers of the pictures' size: 16 bytes a pixel.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        viewing: &Viewing,
    ) -> Result<Self, ScoreError> {
        let gpu = Gpu::from_parts(device.clone(), queue.clone());
        Ok(Self {
            centres: viewing.bands(),
            geometry: Geometry::new(viewing),
            passes: Passes::new(&gpu, viewing)?,
            pool: Pool::default(),
            gpu_time: None,
            viewing: viewing.clone(),
        })
    }

    /// Scores the next frame, as [`super::Judge::frame`] does.
    ///
    /// # Errors
    /// When a picture has another size than the judge was made for, the gaze is no number, or the
    /// device fails.
    pub fn frame(
        &mut self,
        reference: &ScorePicture,
        test: &ScorePicture,
        gaze_px: [f64; 2],
    ) -> Result<FrameScore, ScoreError> {
        for (picture, which) in [reference, test].into_iter().zip(0..) {
            picture.expect_size(self.viewing.size)?;
            match picture.samples() {
                Samples::Bits8(bytes) => self.passes.take_bytes(which, bytes),
                _ => {
                    let light = picture.luminance(&self.viewing.display);
                    let light: Vec<f32> = light.iter().map(|light| *light as f32).collect();
                    self.passes.take_light(which, &light);
                }
            }
        }
        if !gaze_px.iter().all(|place| place.is_finite()) {
            let found = format!("{},{}", gaze_px[0], gaze_px[1]);
            return Err(ScoreError::field("the gaze", found, "two numbers"));
        }
        let (sums, gpu_time) = self.passes.run(self.geometry.gaze(gaze_px))?;
        self.gpu_time = gpu_time;
        let score = FrameScore::new(&sums, self.viewing.foveated);
        self.pool.add(&score);
        Ok(score)
    }

    /// The score of all frames so far; `None` before the first.
    #[must_use]
    pub fn score(&self) -> Option<Score> {
        self.pool.score(&self.centres)
    }

    /// From now on adds up a heat map too.
    ///
    /// # Errors
    /// When the device cannot bind its planes.
    pub fn keep_heat(&mut self) -> Result<(), ScoreError> {
        self.passes.keep_heat()
    }

    /// The mean heat map of all frames since [`Self::keep_heat`]; `None` without it.
    ///
    /// # Errors
    /// When the device fails.
    pub fn heat(&self) -> Result<Option<HeatMap>, ScoreError> {
        let frames = self.score().map_or(1, |score| score.frames) as f32;
        let sums = self.passes.heat()?;
        Ok(sums.map(|sums| HeatMap {
            size: self.viewing.size,
            jod_lost: sums.iter().map(|sum| sum / frames).collect(),
        }))
    }

    /// How long the passes of the last frame took by the device's time stamps, where it has them.
    #[must_use]
    pub fn gpu_time(&self) -> Option<Duration> {
        self.gpu_time
    }
}

#[cfg(test)]
mod tests;
