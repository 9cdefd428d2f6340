//! What does importance cost at a size, with content that needs no download?
//!
//! The caller has the clock; the GPU's own is in what comes back.

use super::{Importance, PendingGains, UnitIds, upload_picture};
use crate::{device::Gpu, error::RenderError, image::RgbaImage};
use foveal_core::perception::eye::Gaze;
use foveal_core::perception::importance::Onlooker;
use foveal_core::perception::parameters::{EyeState, Parameters};
use foveal_core::perception::pyramid::{doubled, halved};
use foveal_core::units::Radians;
use foveal_core::view::axes::{Axes, direction_from_yaw_pitch};
use foveal_core::view::eye_view::{EyeView, Field};

/// Pixels on a side of a unit.
const UNIT: u32 = 64;
/// Field of view in degrees, a desktop screen's.
const ACROSS_DEG: f64 = 40.0;

/// Seeded pictures with detail in every octave, cut into square units, ready to be judged.
pub struct Trial {
    importance: Importance,
    levels: Vec<wgpu::Texture>,
    unit_ids: UnitIds,
    onlooker: Onlooker,
}

impl Trial {
    /// Pictures of `size` pixels in `levels` levels, each with half the detail of the one before.
    /// Costs some hundredths of a microsecond for each pixel and level.
    ///
    /// # Errors
    /// As [`Importance::new`] and [`upload_picture`].
    pub fn new(gpu: &Gpu, size: [u32; 2], levels: usize) -> Result<Self, RenderError> {
        let importance = Importance::new(gpu, size, &Parameters::default())?;
        let pictures = pictures(size, levels);
        let across = size[0].div_ceil(UNIT);
        let units = (across * size[1].div_ceil(UNIT)) as usize;
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        let ids: Vec<u32> = pixels.map(|[x, y]| y / UNIT * across + x / UNIT).collect();
        let degrees = Radians::from_degrees;
        Ok(Self {
            importance,
            levels: pictures
                .iter()
                .map(|picture| upload_picture(gpu, picture))
                .collect::<Result<_, _>>()?,
            unit_ids: UnitIds::upload(gpu, size, &ids, units)?,
            onlooker: Onlooker {
                view: EyeView {
                    axes: Axes::FRONT,
                    field: Field::across(degrees(ACROSS_DEG), size),
                    size,
                },
                gaze: Gaze {
                    direction: direction_from_yaw_pitch(degrees(5.0), degrees(-3.0)),
                    spread: degrees(1.0),
                },
                state: EyeState::Steady,
            },
        })
    }

    /// Orders the value of every step once.
    ///
    /// # Errors
    /// As [`Importance::start`].
    pub fn start(&mut self) -> Result<PendingGains, RenderError> {
        let levels: Vec<&wgpu::Texture> = self.levels.iter().collect();
        self.importance
            .start(&levels, &self.unit_ids, &self.onlooker)
    }

    /// [`Self::start`], waited for.
    ///
    /// # Errors
    /// As [`Importance::run`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(&mut self) -> Result<super::UnitGains, RenderError> {
        self.start()?.wait(&self.importance.gpu)
    }
}

/// Grey noise with as much contrast in every octave, as natural pictures have, and its coarser
/// levels at the same size.
fn pictures(size: [u32; 2], levels: usize) -> Vec<RgbaImage> {
    let mut seed = 1_u32;
    let mut noise = |count: usize| -> Vec<f64> {
        let one = |_| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
        };
        (0..count).map(one).collect()
    };
    let mut chain = vec![size];
    while chain[chain.len() - 1].iter().all(|&side| side > 4) {
        chain.push(chain[chain.len() - 1].map(|side| side.div_ceil(2)));
    }
    let texels = |[w, h]: [u32; 2]| w as usize * h as usize;
    let mut codes = vec![0.0; texels(chain[chain.len() - 1])];
    for octave in (0..chain.len()).rev() {
        if let Some(coarser) = chain.get(octave + 1) {
            codes = doubled(&codes, *coarser, chain[octave]);
        }
        let detail = noise(codes.len());
        codes
            .iter_mut()
            .zip(detail)
            .for_each(|(c, d)| *c += 50.0 * d);
    }
    (0..levels)
        .map(|level| {
            let coarse = coarsened(codes.clone(), &chain[..chain.len().min(level + 1)]);
            grey(size, &coarse)
        })
        .collect()
}

/// What is left of a picture after halving it along `chain` and doubling it back.
fn coarsened(mut codes: Vec<f64>, chain: &[[u32; 2]]) -> Vec<f64> {
    for size in &chain[..chain.len() - 1] {
        codes = halved(&codes, *size).0;
    }
    for pair in chain.windows(2).rev() {
        codes = doubled(&codes, pair[1], pair[0]);
    }
    codes
}

fn grey(size: [u32; 2], codes: &[f64]) -> RgbaImage {
    let pixel = |code: &f64| {
        let code = (128.0 + code).clamp(0.0, 255.0) as u8;
        [code, code, code, 255]
    };
    RgbaImage {
        size,
        pixels: codes.iter().flat_map(pixel).collect(),
    }
}
