//! What is a step to a finer level worth to every unit, computed on the GPU?
//!
//! Six passes, in this order: `luminance`, `halve`, `contrast`, `seen`, `gain`, `accumulate`. Their
//! twin, in double precision, is [`foveal_core::perception::importance`]; `tests/importance.rs`
//! holds them against it. Pictures stay on the GPU: only the sums of units come back.

mod bands;
pub(crate) mod marks;
mod params;
mod pictures;
mod sums;
mod tables;

pub use params::{BandParams, EyeParams};
pub use pictures::{UnitIds, upload_picture};
pub use sums::{PendingGains, UnitGains};

use crate::gpu::buffers::storage;
use crate::gpu::compute::{Compute, Dispatch, record};
use crate::gpu::readback::BytesBack;
use crate::gpu::timer::Timer;
use crate::{error::RenderError, gpu::device::Gpu, shaders};
use bands::{BandBuffers, EyeBuffers, TILE};
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::units::Radians;
use sums::SumsShape;
use tables::{EyeTables, row_from_chord};

/// Pixels that a workgroup of `accumulate` does.
const ACCUMULATE_TILE: [u32; 2] = [64, 16];

/// Judges pictures of one size for one set of parameters; keeps pipelines, tables and buffers, 32
/// bytes a pixel.
pub struct Importance {
    gpu: Gpu,
    size: [u32; 2],
    parameters: Parameters,
    bands: BandBuffers,
    eye: EyeBuffers,
    looking: EyeTables,
    jumping: Option<EyeTables>,
    /// Whether the tables on the GPU are those of a jumping eye.
    uploaded_jumping: Option<bool>,
    /// The spread that the table of chords on the GPU takes in.
    uploaded_spread: Option<Radians>,
    luminance: Compute,
    accumulate: Compute,
    fixed: Fixed,
    timer: Option<Timer>,
}

/// Passes whose buffers never change.
struct Fixed {
    seen: Vec<Dispatch>,
    /// Into contrasts 0 and into contrasts 1.
    pyramid: [Vec<Dispatch>; 2],
    /// Steps to the contrasts 0 and 1, the coarsest band first.
    gain: [Vec<Dispatch>; 2],
}

impl Importance {
    /// For pictures of `size` pixels.
    ///
    /// # Errors
    /// When the device cannot bind buffers of that size (8 bytes a pixel).
    pub fn new(gpu: &Gpu, size: [u32; 2], parameters: &Parameters) -> Result<Self, RenderError> {
        let bands = BandBuffers::new(gpu, size, parameters)?;
        let looking = EyeTables::new(parameters, EyeState::Steady);
        let eye = EyeBuffers::new(gpu, &looking)?;
        let [luminance, halve, contrast, seen, gain, accumulate] =
            shaders::importance().map(|shader| Compute::new(gpu, &shader));
        let pyramid = |slot| bands.pyramid(gpu, &halve, &contrast, slot);
        let fixed = Fixed {
            seen: bands.seen(gpu, &seen, &eye),
            pyramid: [pyramid(0), pyramid(1)],
            gain: [0, 1].map(|after| bands.gain(gpu, &gain, &eye, after)),
        };
        Ok(Self {
            gpu: gpu.clone(),
            size,
            parameters: parameters.clone(),
            bands,
            eye,
            looking,
            jumping: None,
            uploaded_jumping: None,
            uploaded_spread: None,
            luminance,
            accumulate,
            fixed,
            timer: Timer::new(gpu),
        })
    }

    /// Orders the value of every step between `levels`, pictures of the view's size with the finest
    /// first: rgba8unorm textures of sRGB codes with `TEXTURE_BINDING`, such as
    /// [`crate::Renderer::draw`] returns.
    ///
    /// When the gaze has another spread than the last one its table is rebuilt: some
    /// milliseconds of CPU.
    ///
    /// # Errors
    /// When a picture, the unit ids or the view have another size than [`Self::new`] was given, or
    /// the device cannot bind the sums (8 bytes for each unit and step).
    pub fn start(
        &mut self,
        levels: &[&wgpu::Texture],
        unit_ids: &UnitIds,
        onlooker: &Onlooker,
    ) -> Result<PendingGains, RenderError> {
        self.check(levels, unit_ids, onlooker)?;
        let shape = SumsShape::new(&self.gpu, levels.len().saturating_sub(1), unit_ids);
        let sums = storage(&self.gpu, "sums of units", shape.bytes())?;
        let quantum = self.look(onlooker);
        let luminance: Vec<Dispatch> = levels.iter().map(|level| self.light(level)).collect();
        let accumulate: Vec<Dispatch> = (0..shape.steps)
            .map(|step| self.sum(unit_ids, &sums, &shape, step))
            .collect();
        let mut encoder = self.gpu.encoder("importance");
        let passes = self.passes(&luminance, &accumulate);
        record(&mut encoder, "importance", self.timer.as_ref(), passes);
        let times = self.timer.as_ref().map_or(0, |_| Timer::BYTES);
        let back = BytesBack::buffer(&self.gpu, (shape.bytes() + times).max(8));
        encoder.copy_buffer_to_buffer(&sums, 0, &back, 0, shape.bytes());
        if let Some(timer) = &self.timer {
            timer.copy(&mut encoder, &back, shape.bytes());
        }
        self.gpu.submit(encoder);
        Ok(PendingGains {
            bytes: BytesBack::map(back),
            shape,
            quantum,
            tick: self.timer.as_ref().map(Timer::tick),
        })
    }

    /// [`Self::start`], waited for.
    ///
    /// # Errors
    /// As [`Self::start`] and [`PendingGains::wait`].
    ///
    /// ```no_run
    /// # use foveal_core::perception::{importance::Onlooker, parameters::Parameters};
    /// # use foveal_render::{Gpu, RenderError, RgbaImage};
    /// # use foveal_render::importance::{Importance, UnitIds, upload_picture};
    /// # fn judge(fine: &RgbaImage, coarse: &RgbaImage, onlooker: &Onlooker)
    /// # -> Result<(), RenderError> {
    /// let gpu = Gpu::open_blocking()?;
    /// let mut importance = Importance::new(&gpu, fine.size, &Parameters::default())?;
    /// let levels = [upload_picture(&gpu, fine)?, upload_picture(&gpu, coarse)?];
    /// let one_unit = vec![0; fine.size[0] as usize * fine.size[1] as usize];
    /// let ids = UnitIds::upload(&gpu, fine.size, &one_unit, 1)?;
    /// let gains = importance.run(&[&levels[0], &levels[1]], &ids, onlooker)?;
    /// println!("worth {}, found in {:?}", gains.per_step[0][0], gains.gpu_time);
    /// # Ok(()) }
    /// ```
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(
        &mut self,
        levels: &[&wgpu::Texture],
        unit_ids: &UnitIds,
        onlooker: &Onlooker,
    ) -> Result<UnitGains, RenderError> {
        self.start(levels, unit_ids, onlooker)?.wait(&self.gpu)
    }

    fn check(
        &self,
        levels: &[&wgpu::Texture],
        unit_ids: &UnitIds,
        onlooker: &Onlooker,
    ) -> Result<(), RenderError> {
        for (level, texture) in levels.iter().enumerate() {
            pictures::check_picture(level, texture, self.size)?;
        }
        pictures::check_ids(unit_ids, self.size)?;
        let words = |[w, h]: [u32; 2]| format!("{w} x {h} pixels");
        if onlooker.view.size == self.size {
            return Ok(());
        }
        Err(RenderError::Misfit {
            what: "the view".to_owned(),
            expected: words(self.size),
            found: words(onlooker.view.size),
        })
    }

    /// Brings what the passes know of the eye up to date; returns the quantum of the sums.
    fn look(&mut self, onlooker: &Onlooker) -> f64 {
        let is_jumping = onlooker.state == EyeState::Jumping;
        let jumping = || EyeTables::new(&self.parameters, EyeState::Jumping);
        let tables = if is_jumping {
            self.jumping.get_or_insert_with(jumping)
        } else {
            &self.looking
        };
        let (eye, quantum) = EyeParams::new(onlooker, &self.parameters, tables.most_seen());
        let queue = &self.gpu.queue;
        queue.write_buffer(&self.eye.eye, 0, bytemuck::bytes_of(&eye));
        if self.uploaded_jumping != Some(is_jumping) {
            self.uploaded_jumping = Some(is_jumping);
            let (seen, places) = (&tables.sensitivities, &tables.places);
            queue.write_buffer(&self.eye.sensitivities, 0, bytemuck::cast_slice(seen));
            queue.write_buffer(&self.eye.places, 0, bytemuck::cast_slice(places));
        }
        if self.uploaded_spread != Some(onlooker.gaze.spread) {
            self.uploaded_spread = Some(onlooker.gaze.spread);
            let rows = row_from_chord(onlooker);
            queue.write_buffer(&self.eye.row_from_chord, 0, bytemuck::cast_slice(&rows));
        }
        quantum
    }

    /// All passes in their order: each level's contrasts are kept until its step to the next finer
    /// one is done.
    fn passes<'a>(
        &'a self,
        luminance: &'a [Dispatch],
        accumulate: &'a [Dispatch],
    ) -> impl Iterator<Item = &'a Dispatch> {
        let of_level = |(level, luminance): (usize, &'a Dispatch)| {
            let slot = level % 2;
            let accumulate = accumulate.get(level);
            let gain = accumulate.map_or(&[][..], |_| &self.fixed.gain[slot]);
            let light = std::iter::once(luminance).chain(&self.fixed.pyramid[slot]);
            light.chain(gain).chain(accumulate)
        };
        let levels = luminance.iter().enumerate().rev();
        self.fixed.seen.iter().chain(levels.flat_map(of_level))
    }

    fn light(&self, level: &wgpu::Texture) -> Dispatch {
        let view = level.create_view(&wgpu::TextureViewDescriptor::default());
        let bindings = [
            (0, self.bands.params[0].as_entire_binding()),
            (1, wgpu::BindingResource::TextureView(&view)),
            (2, self.bands.codes.as_entire_binding()),
            (3, self.bands.light[0].as_entire_binding()),
        ];
        self.luminance.over(&self.gpu, self.size, TILE, &bindings)
    }

    fn sum(
        &self,
        unit_ids: &UnitIds,
        sums: &wgpu::Buffer,
        shape: &SumsShape,
        step: usize,
    ) -> Dispatch {
        let ids = unit_ids
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let of_step = wgpu::BufferBinding {
            buffer: sums,
            offset: step as u64 * shape.stride,
            size: wgpu::BufferSize::new(shape.step_bytes()),
        };
        let bindings = [
            (0, self.bands.params[0].as_entire_binding()),
            (2, self.eye.eye.as_entire_binding()),
            (3, self.eye.row_from_chord.as_entire_binding()),
            (4, self.eye.places.as_entire_binding()),
            (5, self.bands.gains[0].as_entire_binding()),
            (6, wgpu::BindingResource::TextureView(&ids)),
            (7, wgpu::BindingResource::Buffer(of_step)),
        ];
        self.accumulate
            .over(&self.gpu, self.size, ACCUMULATE_TILE, &bindings)
    }
}
