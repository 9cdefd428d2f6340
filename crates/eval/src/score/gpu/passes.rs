//! In which order do the passes of a frame run, and over what?

use super::buffers::{
    EyeUniform, Level, SUMS_A_GROUP, Tap, groups, light_of_codes, of_numbers, over, refused,
    storage, uniform,
};
use super::shaders::score_shaders;
use crate::score::error::ScoreError;
use crate::score::fast::{BandEye, Table};
use crate::score::geometry::{Geometry, Tangents};
use crate::score::pooling::BandSums;
use crate::score::sensitivity::LogSensitivityTable;
use crate::score::viewing::Viewing;
use foveal_render::Gpu;
use foveal_render::gpu::compute::{Compute, Dispatch, record};
use foveal_render::gpu::readback::BytesBack;
use foveal_render::gpu::timer::Timer;
use std::time::Duration;

/// Pipelines and buffers of frames of one size.
pub(super) struct Passes {
    gpu: Gpu,
    viewing: Viewing,
    table: Table,
    eyes: Vec<BandEye>,
    levels: Vec<Level>,
    level_uniforms: Vec<wgpu::Buffer>,
    eye: wgpu::Buffer,
    taps: Vec<wgpu::Buffer>,
    light: wgpu::Buffer,
    /// Bytes of reference and test.
    bytes: [wgpu::Buffer; 2],
    has_bytes: [bool; 2],
    /// Luminance of reference and test, a slot a frame.
    ring: Vec<[wgpu::Buffer; 2]>,
    came: usize,
    /// The planes of every level.
    planes: Vec<wgpu::Buffer>,
    pipelines: Pipelines,
    /// The passes whose buffers never change.
    fixed: Vec<Dispatch>,
    heat: Option<HeatPlanes>,
    sums: wgpu::Buffer,
    back: wgpu::Buffer,
    timer: Option<Timer>,
}

/// What the heat map is made in.
struct HeatPlanes {
    /// A plane a band.
    bands: Vec<wgpu::Buffer>,
    /// Sum over all frames.
    total: wgpu::Buffer,
}

struct Pipelines {
    luminance: Compute,
    temporal: Compute,
    reduce: Compute,
    band: Compute,
    gather: Compute,
    lost: Compute,
}

impl Pipelines {
    fn new(gpu: &Gpu) -> Self {
        let [luminance, temporal, reduce, band, gather, lost] =
            score_shaders().map(|shader| Compute::new(gpu, &shader));
        Self {
            luminance,
            temporal,
            reduce,
            band,
            gather,
            lost,
        }
    }
}

impl Passes {
    pub(super) fn new(gpu: &Gpu, viewing: &Viewing) -> Result<Self, ScoreError> {
        let (geometry, table) = (
            Geometry::new(viewing),
            LogSensitivityTable::of(viewing.rules.sensitivity),
        );
        let (sizes, centres) = (viewing.levels(), viewing.bands());
        let eyes: Vec<BandEye> = centres
            .iter()
            .zip(&sizes)
            .map(|(cpd, size)| BandEye::new(viewing, &geometry, &table, *cpd, *size))
            .collect();
        let table = Table::new(&table);
        let levels = Level::of_bands(viewing, &eyes);
        let last = levels[levels.len() - 1];
        let sums = u64::from(last.first_sum + groups(last.fine).into_iter().product::<u32>())
            * SUMS_A_GROUP as u64
            * 4;
        let pixels = |size: &[usize; 2]| (size[0] * size[1]) as u64;
        let picture = |what, bytes: u64| storage(gpu, what, pixels(&sizes[0]) * bytes);
        let slot = || -> Result<[wgpu::Buffer; 2], ScoreError> {
            Ok([picture("luminance", 4)?, picture("luminance", 4)?])
        };
        let tap = |(age, weights): (usize, &[f64; 2])| {
            let tap = Tap {
                weights: weights.map(|weight| weight as f32),
                is_first: u32::from(age == 0),
                spare: 0,
            };
            uniform(gpu, "tap", &tap)
        };
        let taps = viewing.taps();
        let planes = sizes
            .iter()
            .map(|size| storage(gpu, "planes", pixels(size) * 16));
        let level_uniforms = levels.iter().map(|level| uniform(gpu, "level", level));
        let looking = eyes[0].looking([0.0; 2]);
        let mut passes = Self {
            gpu: gpu.clone(),
            level_uniforms: level_uniforms.collect(),
            eye: uniform(
                gpu,
                "eye",
                &EyeUniform::new(viewing, &table, &looking, false),
            ),
            taps: taps.iter().enumerate().map(tap).collect(),
            light: of_numbers(gpu, "light of codes", &light_of_codes(&viewing.display))?,
            bytes: [picture("bytes", 3)?, picture("bytes", 3)?],
            has_bytes: [false; 2],
            ring: taps.iter().map(|_| slot()).collect::<Result<_, _>>()?,
            came: 0,
            planes: planes.collect::<Result<_, _>>()?,
            sums: storage(gpu, "sums", sums)?,
            back: BytesBack::buffer(gpu, sums.next_multiple_of(16) + Timer::BYTES),
            timer: Timer::new(gpu),
            pipelines: Pipelines::new(gpu),
            fixed: Vec::new(),
            heat: None,
            viewing: viewing.clone(),
            table,
            eyes,
            levels,
        };
        passes.fixed = passes.fixed()?;
        Ok(passes)
    }

    /// From now on adds up a heat map too.
    pub(super) fn keep_heat(&mut self) -> Result<(), ScoreError> {
        let gpu = &self.gpu;
        let plane = |level: &Level| {
            storage(
                gpu,
                "heat",
                level.fine.into_iter().map(u64::from).product::<u64>() * 4,
            )
        };
        self.heat = Some(HeatPlanes {
            bands: self.levels.iter().map(plane).collect::<Result<_, _>>()?,
            total: plane(&self.levels[0])?,
        });
        self.fixed = self.fixed()?;
        Ok(())
    }

    /// The passes whose buffers never change: every level, every band, and what is wanted of the
    /// heat map.
    fn fixed(&self) -> Result<Vec<Dispatch>, ScoreError> {
        let gpu = &self.gpu;
        let (reduce, band) = (&self.pipelines.reduce, &self.pipelines.band);
        let unused = storage(gpu, "no heat", 4)?;
        let sensitivities = of_numbers(gpu, "sensitivities", &self.table.entries)?;
        let raised = of_numbers(gpu, "raised", &self.table.raised)?;
        let (mut fixed, mut bands) = (Vec::new(), Vec::new());
        for (n, (level, eye)) in self.levels.iter().zip(&self.eyes).enumerate() {
            let [uniform, fine, coarse] = [
                &self.level_uniforms[n],
                &self.planes[n],
                &self.planes[n + 1],
            ];
            fixed.push(over(reduce, gpu, level.coarse, &[uniform, fine, coarse]));
            let axes = of_numbers(gpu, "axes", &eye.axes.concat())?;
            let frequency = of_numbers(gpu, "frequencies", &eye.frequency)?;
            let buffers = [
                uniform,
                &self.eye,
                fine,
                coarse,
                &axes,
                &frequency,
                &sensitivities,
                &raised,
                &self.sums,
                self.heat.as_ref().map_or(&unused, |heat| &heat.bands[n]),
            ];
            bands.push(over(band, gpu, level.fine, &buffers));
        }
        fixed.append(&mut bands);
        if let Some(heat) = &self.heat {
            fixed.append(&mut self.heat_passes(heat));
        }
        Ok(fixed)
    }

    /// From the coarsest band to the finest, then onto the sum.
    fn heat_passes(&self, heat: &HeatPlanes) -> Vec<Dispatch> {
        let gather = |n: usize| {
            let buffers = [&self.level_uniforms[n], &heat.bands[n + 1], &heat.bands[n]];
            over(
                &self.pipelines.gather,
                &self.gpu,
                self.levels[n].fine,
                &buffers,
            )
        };
        let mut passes: Vec<Dispatch> = (0..heat.bands.len() - 1).rev().map(gather).collect();
        let buffers = [&self.level_uniforms[0], &heat.bands[0], &heat.total];
        passes.push(over(
            &self.pipelines.lost,
            &self.gpu,
            self.viewing.size,
            &buffers,
        ));
        passes
    }

    /// The sum of the heat maps of all frames; `None` where none is kept.
    pub(super) fn heat(&self) -> Result<Option<Vec<f32>>, ScoreError> {
        let Some(heat) = &self.heat else {
            return Ok(None);
        };
        let bytes = heat.total.size();
        let back = BytesBack::buffer(&self.gpu, bytes);
        let mut encoder = self.gpu.encoder("heat map");
        encoder.copy_buffer_to_buffer(&heat.total, 0, &back, 0, bytes);
        self.gpu.submit(encoder);
        let bytes = BytesBack::map(back).wait(&self.gpu).map_err(refused)?;
        let mut numbers = numbers(&bytes);
        numbers.truncate(
            self.viewing
                .size
                .into_iter()
                .map(|side| side as usize)
                .product(),
        );
        Ok(Some(numbers))
    }

    fn slot(&self) -> usize {
        self.came % self.ring.len()
    }

    /// The bytes of the next frame of the reference (0) or the test (1).
    pub(super) fn take_bytes(&mut self, which: usize, rgb: &[u8]) {
        let whole = rgb.len() / 4 * 4;
        self.gpu
            .queue
            .write_buffer(&self.bytes[which], 0, &rgb[..whole]);
        let mut rest = [0; 4];
        rest[..rgb.len() - whole].copy_from_slice(&rgb[whole..]);
        if rgb.len() > whole {
            self.gpu
                .queue
                .write_buffer(&self.bytes[which], whole as u64, &rest);
        }
        self.has_bytes[which] = true;
    }

    /// The luminance of the next frame of the reference (0) or the test (1).
    pub(super) fn take_light(&mut self, which: usize, light: &[f32]) {
        let slot = &self.ring[self.slot()][which];
        self.gpu
            .queue
            .write_buffer(slot, 0, bytemuck::cast_slice(light));
        self.has_bytes[which] = false;
    }

    /// The sums of every band of the frame that was taken, and how long the device took.
    pub(super) fn run(
        &mut self,
        gaze: Tangents,
    ) -> Result<(Vec<BandSums>, Option<Duration>), ScoreError> {
        let looking = self.eyes[0].looking(gaze);
        let eye = EyeUniform::new(&self.viewing, &self.table, &looking, self.heat.is_some());
        self.gpu
            .queue
            .write_buffer(&self.eye, 0, bytemuck::bytes_of(&eye));
        let light = self.light_passes();
        self.came += 1;
        let temporal = self.temporal_passes();
        let mut encoder = self.gpu.encoder("score");
        let passes = light.iter().chain(&temporal).chain(&self.fixed);
        record(&mut encoder, "score", self.timer.as_ref(), passes);
        let bytes = self.back.size() - Timer::BYTES;
        encoder.copy_buffer_to_buffer(&self.sums, 0, &self.back, 0, bytes);
        if let Some(timer) = &self.timer {
            timer.copy(&mut encoder, &self.back, bytes);
        }
        self.gpu.submit(encoder);
        self.read_back()
    }

    fn light_passes(&self) -> Vec<Dispatch> {
        let size = self.viewing.size;
        let slot = &self.ring[self.slot()];
        let taken = [0, 1]
            .into_iter()
            .filter(|which: &usize| self.has_bytes[*which]);
        taken
            .map(|which| {
                let (bytes, out) = (&self.bytes[which], &slot[which]);
                let buffers = [&self.level_uniforms[0], bytes, &self.light, out];
                over(&self.pipelines.luminance, &self.gpu, size, &buffers)
            })
            .collect()
    }

    /// One for every frame of a quarter of a second; before the first frame it was shown.
    fn temporal_passes(&self) -> Vec<Dispatch> {
        let newest = self.came - 1;
        let pass = |(age, tap): (usize, &wgpu::Buffer)| {
            let [reference, test] = &self.ring[(newest - age.min(newest)) % self.ring.len()];
            let buffers = [
                &self.level_uniforms[0],
                tap,
                reference,
                test,
                &self.planes[0],
            ];
            over(
                &self.pipelines.temporal,
                &self.gpu,
                self.viewing.size,
                &buffers,
            )
        };
        self.taps.iter().enumerate().map(pass).collect()
    }

    fn read_back(&self) -> Result<(Vec<BandSums>, Option<Duration>), ScoreError> {
        let back = BytesBack::map(self.back.clone());
        let bytes = back.wait(&self.gpu).map_err(refused)?;
        let (sums, stamps) = bytes.split_at(bytes.len() - Timer::BYTES as usize);
        let timer = self.timer.as_ref();
        let time = timer.and_then(|timer| timer.tick().between(stamps));
        let sums = numbers(sums);
        let of_band = |level: &Level| {
            let first = level.first_sum as usize * SUMS_A_GROUP;
            let count = groups(level.fine).into_iter().product::<u32>() as usize * SUMS_A_GROUP;
            band_sums(&sums[first..first + count])
        };
        Ok((self.levels.iter().map(of_band).collect(), time))
    }
}

/// The sums of one band from those of its workgroups.
fn band_sums(groups: &[f32]) -> BandSums {
    let mut sums = BandSums::default();
    for group in groups.chunks_exact(SUMS_A_GROUP) {
        for zone in 0..3 {
            sums.sums[zone][0] += f64::from(group[zone * 2]);
            sums.sums[zone][1] += f64::from(group[zone * 2 + 1]);
            sums.pixels[zone] += f64::from(group[6 + zone]);
        }
    }
    sums
}

fn numbers(bytes: &[u8]) -> Vec<f32> {
    let fours = bytes.chunks_exact(4);
    fours
        .map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]))
        .collect()
}
