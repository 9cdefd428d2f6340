//! In which order do the passes of a frame run, and over what?

use super::buffers::{EyeUniform, Level, Maker, SUMS_A_GROUP, Tap, groups, light_of_codes};
use super::pipeline::{Dispatch, Pipeline};
use super::shaders::score_shaders;
use super::stamps::Stamps;
use crate::score::error::ScoreError;
use crate::score::fast::{BandEye, Table};
use crate::score::geometry::{Geometry, Tangents};
use crate::score::pooling::BandSums;
use crate::score::sensitivity::LogSensitivityTable;
use crate::score::viewing::Viewing;
use std::sync::mpsc;
use std::time::Duration;

/// Pipelines and buffers of frames of one size.
pub(super) struct Passes {
    device: wgpu::Device,
    queue: wgpu::Queue,
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
    stamps: Option<Stamps>,
}

/// What the heat map is made in.
struct HeatPlanes {
    /// A plane a band.
    bands: Vec<wgpu::Buffer>,
    /// Sum over all frames.
    total: wgpu::Buffer,
}

struct Pipelines {
    luminance: Pipeline,
    temporal: Pipeline,
    reduce: Pipeline,
    band: Pipeline,
    gather: Pipeline,
    lost: Pipeline,
}

impl Pipelines {
    fn new(device: &wgpu::Device) -> Self {
        let [luminance, temporal, reduce, band, gather, lost] =
            score_shaders().map(|shader| Pipeline::new(device, &shader));
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
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        viewing: &Viewing,
    ) -> Result<Self, ScoreError> {
        let make = Maker { device, queue };
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
        let picture = |what, bytes: u64| make.storage(what, pixels(&sizes[0]) * bytes);
        let slot = || -> Result<[wgpu::Buffer; 2], ScoreError> {
            Ok([picture("luminance", 4)?, picture("luminance", 4)?])
        };
        let tap = |(age, weights): (usize, &[f64; 2])| {
            let tap = Tap {
                weights: weights.map(|weight| weight as f32),
                is_first: u32::from(age == 0),
                spare: 0,
            };
            make.uniform("tap", &tap)
        };
        let taps = viewing.taps();
        let planes = sizes
            .iter()
            .map(|size| make.storage("planes", pixels(size) * 16));
        let level_uniforms = levels.iter().map(|level| make.uniform("level", level));
        let looking = eyes[0].looking([0.0; 2]);
        let mut passes = Self {
            device: device.clone(),
            queue: queue.clone(),
            level_uniforms: level_uniforms.collect(),
            eye: make.uniform("eye", &EyeUniform::new(viewing, &table, &looking, false)),
            taps: taps.iter().enumerate().map(tap).collect(),
            light: make.numbers("light of codes", &light_of_codes(&viewing.display))?,
            bytes: [picture("bytes", 3)?, picture("bytes", 3)?],
            has_bytes: [false; 2],
            ring: taps.iter().map(|_| slot()).collect::<Result<_, _>>()?,
            came: 0,
            planes: planes.collect::<Result<_, _>>()?,
            sums: make.storage("sums", sums)?,
            back: read_back_buffer(device, sums.next_multiple_of(16) + Stamps::BYTES),
            stamps: Stamps::new(device, queue),
            pipelines: Pipelines::new(device),
            fixed: Vec::new(),
            heat: None,
            viewing: viewing.clone(),
            table,
            eyes,
            levels,
        };
        passes.fixed = passes.fixed(&make)?;
        Ok(passes)
    }

    /// From now on adds up a heat map too.
    pub(super) fn keep_heat(&mut self) -> Result<(), ScoreError> {
        let (device, queue) = (self.device.clone(), self.queue.clone());
        let make = Maker {
            device: &device,
            queue: &queue,
        };
        let plane = |level: &Level| {
            make.storage(
                "heat",
                level.fine.into_iter().map(u64::from).product::<u64>() * 4,
            )
        };
        self.heat = Some(HeatPlanes {
            bands: self.levels.iter().map(plane).collect::<Result<_, _>>()?,
            total: plane(&self.levels[0])?,
        });
        self.fixed = self.fixed(&make)?;
        Ok(())
    }

    /// The passes whose buffers never change: every level, every band, and what is wanted of the
    /// heat map.
    fn fixed(&self, make: &Maker<'_>) -> Result<Vec<Dispatch>, ScoreError> {
        let (reduce, band) = (&self.pipelines.reduce, &self.pipelines.band);
        let unused = make.storage("no heat", 4)?;
        let sensitivities = make.numbers("sensitivities", &self.table.entries)?;
        let raised = make.numbers("raised", &self.table.raised)?;
        let (mut fixed, mut bands) = (Vec::new(), Vec::new());
        for (n, (level, eye)) in self.levels.iter().zip(&self.eyes).enumerate() {
            let [uniform, fine, coarse] = [
                &self.level_uniforms[n],
                &self.planes[n],
                &self.planes[n + 1],
            ];
            fixed.push(reduce.over(make.device, level.coarse, &[uniform, fine, coarse]));
            let axes = make.numbers("axes", &eye.axes.concat())?;
            let frequency = make.numbers("frequencies", &eye.frequency)?;
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
            bands.push(band.over(make.device, level.fine, &buffers));
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
            self.pipelines
                .gather
                .over(&self.device, self.levels[n].fine, &buffers)
        };
        let mut passes: Vec<Dispatch> = (0..heat.bands.len() - 1).rev().map(gather).collect();
        let buffers = [&self.level_uniforms[0], &heat.bands[0], &heat.total];
        passes.push(
            self.pipelines
                .lost
                .over(&self.device, self.viewing.size, &buffers),
        );
        passes
    }

    /// The sum of the heat maps of all frames; `None` where none is kept.
    pub(super) fn heat(&self) -> Result<Option<Vec<f32>>, ScoreError> {
        let Some(heat) = &self.heat else {
            return Ok(None);
        };
        let bytes = heat.total.size();
        let back = read_back_buffer(&self.device, bytes);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&heat.total, 0, &back, 0, bytes);
        self.queue.submit([encoder.finish()]);
        let mut numbers = numbers(&mapped(&self.device, &back)?);
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
        self.queue
            .write_buffer(&self.bytes[which], 0, &rgb[..whole]);
        let mut rest = [0; 4];
        rest[..rgb.len() - whole].copy_from_slice(&rgb[whole..]);
        if rgb.len() > whole {
            self.queue
                .write_buffer(&self.bytes[which], whole as u64, &rest);
        }
        self.has_bytes[which] = true;
    }

    /// The luminance of the next frame of the reference (0) or the test (1).
    pub(super) fn take_light(&mut self, which: usize, light: &[f32]) {
        let slot = &self.ring[self.slot()][which];
        self.queue
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
        self.queue
            .write_buffer(&self.eye, 0, bytemuck::bytes_of(&eye));
        let light = self.light_passes();
        self.came += 1;
        let temporal = self.temporal_passes();
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("score"),
            timestamp_writes: self.stamps.as_ref().map(Stamps::around),
        });
        for dispatch in light.iter().chain(&temporal).chain(&self.fixed) {
            dispatch.order(&mut pass);
        }
        drop(pass);
        let bytes = self.back.size() - Stamps::BYTES;
        encoder.copy_buffer_to_buffer(&self.sums, 0, &self.back, 0, bytes);
        if let Some(stamps) = &self.stamps {
            stamps.copy(&mut encoder, &self.back, bytes);
        }
        self.queue.submit([encoder.finish()]);
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
                self.pipelines.luminance.over(&self.device, size, &buffers)
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
            self.pipelines
                .temporal
                .over(&self.device, self.viewing.size, &buffers)
        };
        self.taps.iter().enumerate().map(pass).collect()
    }

    fn read_back(&self) -> Result<(Vec<BandSums>, Option<Duration>), ScoreError> {
        let bytes = mapped(&self.device, &self.back)?;
        let (sums, stamps) = bytes.split_at(bytes.len() - Stamps::BYTES as usize);
        let time = self.stamps.as_ref().and_then(|clock| clock.between(stamps));
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

fn read_back_buffer(device: &wgpu::Device, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: bytes,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

/// The bytes of a buffer, once the device is done with it.
fn mapped(device: &wgpu::Device, buffer: &wgpu::Buffer) -> Result<Vec<u8>, ScoreError> {
    let failed = |reason: String| ScoreError::Device(format!("the device failed: {reason}"));
    let (tell, told) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // Nobody listens only when the poll below failed.
        let _ = tell.send(result);
    });
    device
        .poll(wgpu::PollType::wait_indefinitely())
        .map_err(|reason| failed(reason.to_string()))?;
    let mapped = told.recv().map_err(|reason| failed(reason.to_string()))?;
    mapped.map_err(|reason| failed(reason.to_string()))?;
    let view = buffer
        .get_mapped_range(..)
        .map_err(|reason| failed(reason.to_string()))?;
    let bytes = view.to_vec();
    drop(view);
    buffer.unmap();
    Ok(bytes)
}

fn numbers(bytes: &[u8]) -> Vec<f32> {
    let fours = bytes.chunks_exact(4);
    fours
        .map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]))
        .collect()
}
