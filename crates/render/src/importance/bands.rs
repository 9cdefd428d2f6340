//! Which buffers lie between the passes?

use super::params::{BandParams, EyeParams};
use super::tables::{CHORDS, EyeTables};
use crate::gpu::buffers::{filled, storage};
use crate::gpu::compute::{Compute, Dispatch};
use crate::{error::RenderError, gpu::device::Gpu};
use foveal_core::perception::measures::pyramid::bands_of;
use foveal_core::perception::parameters::Parameters;

/// Texels on a side that a workgroup of most passes does.
pub(super) const TILE: [u32; 2] = [8, 8];

const UNIFORM: wgpu::BufferUsages = wgpu::BufferUsages::UNIFORM;
const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE;

/// What pictures are taken apart into, band by band, the finest first.
pub(super) struct BandBuffers {
    /// One at least; only the first `count` have contrasts.
    bands: Vec<BandParams>,
    count: usize,
    pub(super) params: Vec<wgpu::Buffer>,
    /// Luminance that a code adds.
    pub(super) codes: wgpu::Buffer,
    /// Luminance of every band's level, and of one more below.
    pub(super) light: Vec<wgpu::Buffer>,
    /// Contrasts of two pictures in turn.
    contrasts: [Vec<wgpu::Buffer>; 2],
    seen: Vec<wgpu::Buffer>,
    pub(super) gains: Vec<wgpu::Buffer>,
}

/// What the passes know of the eye.
pub(super) struct EyeBuffers {
    pub(super) eye: wgpu::Buffer,
    pub(super) row_from_chord: wgpu::Buffer,
    pub(super) places: wgpu::Buffer,
    pub(super) sensitivities: wgpu::Buffer,
}

impl BandBuffers {
    pub(super) fn new(
        gpu: &Gpu,
        size: [u32; 2],
        parameters: &Parameters,
    ) -> Result<Self, RenderError> {
        let count = bands_of(size);
        // A picture too small for a band still has pixels to sum up.
        let bands: Vec<BandParams> = (0..count.max(1))
            .map(|index| BandParams::new(size, index, count))
            .collect();
        let uniform = |band: &BandParams| filled(gpu, "band", UNIFORM, &[*band]);
        let texels = |what, size: [u32; 2], bytes| {
            storage(gpu, what, u64::from(size[0]) * u64::from(size[1]) * bytes)
        };
        let of_all = |what, bytes| -> Result<Vec<_>, _> {
            let all = bands.iter().map(|band| texels(what, band.fine, bytes));
            all.collect()
        };
        let mut light = of_all("luminance", 4)?;
        light.push(texels("luminance", bands[bands.len() - 1].coarse, 4)?);
        Ok(Self {
            params: bands.iter().map(uniform).collect(),
            codes: filled(gpu, "codes", STORAGE, &light_of_codes(parameters)),
            light,
            contrasts: [of_all("contrasts", 4)?, of_all("contrasts", 4)?],
            seen: of_all("sensitivities", 8)?,
            gains: of_all("gains", 4)?,
            bands,
            count,
        })
    }

    fn banded(&self) -> impl DoubleEndedIterator<Item = (usize, &BandParams)> + ExactSizeIterator {
        self.bands[..self.count].iter().enumerate()
    }

    /// The passes that take the picture's luminance apart into one of the two contrasts.
    pub(super) fn pyramid(
        &self,
        gpu: &Gpu,
        halve: &Compute,
        contrast: &Compute,
        slot: usize,
    ) -> Vec<Dispatch> {
        let both = |index: usize| {
            let band = &self.bands[index];
            let [params, fine, coarse, into] = [
                &self.params[index],
                &self.light[index],
                &self.light[index + 1],
                &self.contrasts[slot][index],
            ]
            .map(wgpu::Buffer::as_entire_binding);
            let halved = [(0, params.clone()), (1, fine.clone()), (2, coarse.clone())];
            let contrasts = [(0, params), (1, coarse), (2, fine), (3, into)];
            [
                halve.over(gpu, band.coarse, TILE, &halved),
                contrast.over(gpu, band.fine, TILE, &contrasts),
            ]
        };
        (0..self.count).flat_map(both).collect()
    }

    /// The passes that say how strongly each band is seen.
    pub(super) fn seen(&self, gpu: &Gpu, seen: &Compute, eye: &EyeBuffers) -> Vec<Dispatch> {
        let one = |(index, band): (usize, &BandParams)| {
            let bindings = [
                (0, self.params[index].as_entire_binding()),
                (2, eye.eye.as_entire_binding()),
                (3, eye.row_from_chord.as_entire_binding()),
                (4, eye.places.as_entire_binding()),
                (5, eye.sensitivities.as_entire_binding()),
                (6, self.seen[index].as_entire_binding()),
            ];
            seen.over(gpu, band.fine, TILE, &bindings)
        };
        self.banded().map(one).collect()
    }

    /// The passes of a step to the contrasts `after` from the other ones, the coarsest band first.
    pub(super) fn gain(
        &self,
        gpu: &Gpu,
        gain: &Compute,
        eye: &EyeBuffers,
        after: usize,
    ) -> Vec<Dispatch> {
        let one = |(index, band): (usize, &BandParams)| {
            // The coarsest band adds nothing from below; what is bound there is not read.
            let below = self.gains.get(index + 1).unwrap_or(&self.light[index + 1]);
            let bindings = [
                (0, self.params[index].as_entire_binding()),
                (1, below.as_entire_binding()),
                (2, eye.eye.as_entire_binding()),
                (3, self.contrasts[1 - after][index].as_entire_binding()),
                (4, self.contrasts[after][index].as_entire_binding()),
                (5, self.seen[index].as_entire_binding()),
                (6, self.gains[index].as_entire_binding()),
            ];
            gain.over(gpu, band.fine, TILE, &bindings)
        };
        self.banded().rev().map(one).collect()
    }
}

impl EyeBuffers {
    /// Buffers for tables of the lengths of `tables`, which all have.
    pub(super) fn new(gpu: &Gpu, tables: &EyeTables) -> Result<Self, RenderError> {
        let rows = (CHORDS + 1) as u64 * 4;
        let places = tables.places.len() as u64 * 4;
        let sensitivities = tables.sensitivities.len() as u64 * 8;
        Ok(Self {
            eye: filled(gpu, "eye", UNIFORM, &[EyeParams::default()]),
            row_from_chord: storage(gpu, "rows from chords", rows)?,
            places: storage(gpu, "places", places)?,
            sensitivities: storage(gpu, "sensitivities", sensitivities)?,
        })
    }
}

/// Luminance that each code of red, green and blue adds to black, and black, in cd/m².
fn light_of_codes(parameters: &Parameters) -> Vec<[f32; 4]> {
    let black = parameters.displayed(0.0);
    let added = |rgb| parameters.luminance_from_rgb(&[rgb])[0] - black;
    (0..=255)
        .map(|code| {
            let rgb = [[code, 0, 0], [0, code, 0], [0, 0, code]].map(added);
            [rgb[0], rgb[1], rgb[2], black].map(|light| light as f32)
        })
        .collect()
}
